// pose_simplex with an invocation a pose, which walks through all points, several a turn of the loop: lavapipe ends loops
// after 65,535 turns, and it does not unroll them itself. The includer defines TWO_POINTS(i), points 2i and 2i + 1, and
// LAST_POINT(i), point i.

layout(set = 0, binding = 0, std430) readonly buffer Field { uint field[]; };

#define FIELD_WORD(i) field[i]
#include "common/launch.glsl"
#include "common/pose_simplex.glsl"

uint two_costs(Costing costing, vec4 points) {
  return point_cost(costing, points.xy) + point_cost(costing, points.zw);
}

uint pose_cost(vec3 pose) {
  Costing costing = costing_of(pose);
  uint eights = params.point_count / 8u;
  uint sum = 0u;
  for (uint i = 0u; i < eights; ++i) {
    sum += two_costs(costing, TWO_POINTS(4u * i));
    sum += two_costs(costing, TWO_POINTS(4u * i + 1u));
    sum += two_costs(costing, TWO_POINTS(4u * i + 2u));
    sum += two_costs(costing, TWO_POINTS(4u * i + 3u));
  }
  for (uint i = 8u * eights; i < params.point_count; ++i) {
    sum += point_cost(costing, LAST_POINT(i));
  }
  return saturating_add(sum, prior_cost(pose_prior(), pose));
}

void main() {
  uint pose = linear_invocation();
  if (pose >= params.count) {
    return;
  }
  Walk walk = begin_walk(pose);
  while (walk.stop == 0u) {
    advance(walk, pose_cost(walk.trial), walk_limits());
  }
  store_walk(pose, walk);
}
