// Cost of candidate poses, a work group a candidate: few of them keep a GPU busy. The sum is of integers, so how it is
// shared out does not matter.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"

layout(constant_id = 10) const uint kInterpolation = 0;  // a constant, for devices that run both sides of a branch
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
  uint count;  // number of candidates, from the launch
};
layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };
struct Candidate {
  float x;
  float y;
  float theta;
  uint bias;
};
layout(set = 0, binding = 2, std430) readonly buffer Candidates { Candidate candidates[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Cost { uint cost[]; };

#include "common/field_lookup.glsl"

Costing costing_of(Candidate candidate) {
  return Costing(field_view(width, height, stride, strip, blank, anchor_x, anchor_y), cell_rotation(candidate.theta),
                 vec2(candidate.x, candidate.y), cap, form, squared_shift(cap));
}

uint term(Costing costing, vec2 point) { return point_cost(costing, kInterpolation, point); }

const uint kMostInvocations = 256;
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
