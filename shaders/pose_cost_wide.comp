// Cost of candidate poses, a work group a candidate: few of them keep a GPU busy. The sum is of integers, so how it is
// shared out does not matter.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/pose_cost.glsl"

const uint kMostInvocations = 256;
layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };
shared uint sum_of[kMostInvocations];

void main() {
  uint own = gl_LocalInvocationID.x;
  uint index = linear_group();
  bool is_in_batch = index < count;  // the same for the whole group
  Candidate candidate = candidates[is_in_batch ? index : 0];
  Costing costing = costing_of(candidate);
  uint sum = 0;
  for (uint i = own; i < (is_in_batch ? point_count : 0); i += gl_WorkGroupSize.x) {
    sum += term(costing, points[i]);
  }
  sum_of[own] = sum;
  for (uint half_size = gl_WorkGroupSize.x / 2; half_size > 0; half_size /= 2) {
    barrier();
    if (own < half_size) {
      sum_of[own] += sum_of[own + half_size];
    }
  }
  if (own == 0 && is_in_batch) {
    cost[index] = saturating_add(sum_of[0], candidate.bias);
  }
}
