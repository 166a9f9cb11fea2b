#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (engine/compute/kernels/pose_simplex/pose_simplex.hpp, PoseSimplex): an invocation a pose, which goes
// through all points, several a turn of the loop, for lavapipe ends loops after 65,535 turns and does not unroll them
// itself. The points are in a uniform buffer and the field in texels, from which both come faster there.

#define FIELD_IN_TEXELS
layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two each

vec2 point(uint i) { return vec2(points[i / 2u][(i & 1u) * 2u], points[i / 2u][(i & 1u) * 2u + 1u]); }

#include "common/field_words.glsl"
#include "common/launch.glsl"
#include "common/pose_simplex.glsl"

uint two_costs(Costing costing, vec4 points) {
  return term(costing, points.xy) + term(costing, points.zw);
}

uint pose_cost(vec3 pose) {
  Costing costing = costing_of(pose);
  uint eights = params.point_count / 8u;
  uint sum = 0u;
  for (uint i = 0u; i < eights; ++i) {
    sum += two_costs(costing, points[4u * i]);
    sum += two_costs(costing, points[4u * i + 1u]);
    sum += two_costs(costing, points[4u * i + 2u]);
    sum += two_costs(costing, points[4u * i + 3u]);
  }
  for (uint i = 8u * eights; i < params.point_count; ++i) {
    sum += term(costing, point(i));
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
