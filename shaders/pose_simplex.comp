#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (engine/compute/kernels/pose_simplex/pose_simplex.hpp, PoseSimplex): a group a pose. Its invocations share
// the points, and all of them walk, each with the same bits, so that a barrier a pose is all that they need.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

// Points that an invocation takes in a turn, 1 or 16. lavapipe ends loops after 65,535 turns, and does not unroll them
// itself.
layout(constant_id = 11) const uint kPointsATurn = 1u;

#include "common/launch.glsl"
#include "common/field_lookup.glsl"
#include "common/prior.glsl"
#include "common/simplex.glsl"

layout(constant_id = 10) const uint kInterpolation = 0u;  // a constant, for devices that run both sides of a branch

struct PolishedPose {
  float x;
  float y;
  float theta;
  uint cost;
  uint evaluations;
  uint stop;
  uint reserved0;
  uint reserved1;
};

layout(set = 0, binding = 2, std430) buffer Poses { PolishedPose poses[]; };

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint strip;
  uint blank;
  int anchor_x;
  int anchor_y;
  uint point_count;
  uint cap;
  uint interpolation;
  uint form;
  float mean_x;
  float mean_y;
  float mean_theta;
  float weight_xy;
  float weight_theta;
  float limit;
  float step_cells;
  float step_rad;
  float stop_cells;
  float stop_rad;
  uint max_evaluations;
  uint count;  // number of poses, from the launch
} params;

Prior pose_prior() {
  return Prior(vec3(params.mean_x, params.mean_y, params.mean_theta), params.weight_xy, params.weight_theta,
               params.limit);
}

WalkLimits walk_limits() { return WalkLimits(params.stop_cells, params.stop_rad, params.max_evaluations); }

Costing costing_of(vec3 pose) {
  return Costing(field_view(params.width, params.height, params.stride, params.strip, params.blank, params.anchor_x,
                            params.anchor_y),
                 cell_rotation(pose.z), pose.xy, params.cap, params.form, squared_shift(params.cap));
}

uint term(Costing costing, vec2 point) { return point_cost(costing, kInterpolation, point); }

Walk begin_walk(uint pose) {
  vec3 start = vec3(poses[pose].x, poses[pose].y, poses[pose].theta);
  return first_simplex(start, params.step_cells, params.step_rad);
}

void store_walk(uint pose, Walk walk) {
  poses[pose].x = walk.v0.pose.x;
  poses[pose].y = walk.v0.pose.y;
  poses[pose].theta = walk.v0.pose.z;
  poses[pose].cost = walk.v0.cost;
  poses[pose].evaluations += walk.evaluations;
  poses[pose].stop = walk.stop;
}

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
