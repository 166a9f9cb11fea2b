// What the shaders of pose_cost share: its bindings but for the points, and a point's term of a candidate's cost. The
// arithmetic itself is in field_lookup.glsl.
#ifndef GDTSLAM_POSE_COST_GLSL
#define GDTSLAM_POSE_COST_GLSL

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
  uint count;  // of the candidates, from the launch
};
struct Candidate {
  float x;
  float y;
  float theta;
  uint bias;
};
layout(set = 0, binding = 2, std430) readonly buffer Candidates { Candidate candidates[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Cost { uint cost[]; };

#include "common/field_words.glsl"
#include "common/field_lookup.glsl"

Costing costing_of(Candidate candidate) {
  return Costing(field_view(width, height, stride, strip, blank, anchor_x, anchor_y), cell_rotation(candidate.theta),
                 vec2(candidate.x, candidate.y), cap, form, squared_shift(cap));
}

uint term(Costing costing, vec2 point) { return point_cost(costing, kInterpolation, point); }

#endif
