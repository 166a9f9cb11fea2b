#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (engine/compute/kernels/pose_simplex/pose_simplex.hpp, PoseSimplex): a group a pose. Its invocations share
// the points, and all of them walk, each with the same bits, so that a barrier a pose is all that they need.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

// Of an invocation, 1 or 16. lavapipe ends loops after 65,535 turns, and does not unroll them itself.
layout(constant_id = 11) const uint kPointsATurn = 1u;

#include "common/field_words.glsl"
#include "common/launch.glsl"
#include "common/pose_simplex.glsl"

// Sums of three turns: one is added to, the one before may still be read, the next is made zero. A sum is so written
// again two barriers after it was read.
shared uint turn_sum[3];

uint own_sum(vec3 pose) {
  Costing costing = costing_of(pose);
  uint sum = 0u;
  uint step_width = gl_WorkGroupSize.x;
  for (uint i = gl_LocalInvocationID.x; i < params.point_count; i += kPointsATurn * step_width) {
    sum += term(costing, points[i]);
    if (kPointsATurn > 1u) {
#define ADD(k)                                                                                    \
  {                                                                                               \
    uint beyond = i + (k) * step_width;                                                           \
    uint cost = term(costing, points[min(beyond, params.point_count - 1u)]);                \
    sum += beyond < params.point_count ? cost : 0u;                                               \
  }
      ADD(1u) ADD(2u) ADD(3u) ADD(4u) ADD(5u) ADD(6u) ADD(7u) ADD(8u)
      ADD(9u) ADD(10u) ADD(11u) ADD(12u) ADD(13u) ADD(14u) ADD(15u)
    }
  }
  return sum;
}

void main() {
  uint pose = linear_group();
  if (pose >= params.count) {
    return;  // the whole group
  }
  Walk walk = begin_walk(pose);
  if (gl_LocalInvocationID.x < 3u) {
    turn_sum[gl_LocalInvocationID.x] = 0u;
  }
  barrier();
  uint turn = 0u;
  while (walk.stop == 0u) {
    uint next = turn == 2u ? 0u : turn + 1u;
    if (gl_LocalInvocationID.x == 0u) {
      turn_sum[next] = 0u;
    }
    atomicAdd(turn_sum[turn], own_sum(walk.trial));
    barrier();
    uint cost = saturating_add(turn_sum[turn], prior_cost(pose_prior(), walk.trial));
    advance(walk, cost, walk_limits());
    turn = next;
  }
  if (gl_LocalInvocationID.x == 0u) {
    store_walk(pose, walk);
  }
}
