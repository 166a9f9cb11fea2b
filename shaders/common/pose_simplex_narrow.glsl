// pose_simplex with an invocation a pose, which walks through all points, several a turn of the loop: lavapipe ends loops
// after 65,535 turns, and it does not unroll them itself. The includer defines POINTS_IN_UNIFORM where
// they come in a uniform buffer of at most 16 KiB.

#ifdef POINTS_IN_UNIFORM
layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two each
#define TWO_POINTS(i) points[i]
#define LAST_POINT(i) vec2(points[(i) / 2u][((i) & 1u) * 2u], points[(i) / 2u][((i) & 1u) * 2u + 1u])
#else
layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };
#define TWO_POINTS(i) vec4(points[2u * (i)], points[2u * (i) + 1u])  // points 2i and 2i + 1
#define LAST_POINT(i) points[i]
#endif

#include "common/field_words.glsl"
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
