// What the variants of pose_simplex share. The includer declares FIELD_WORD (field_lookup.glsl).
#ifndef GDTSLAM_POSE_SIMPLEX_GLSL
#define GDTSLAM_POSE_SIMPLEX_GLSL

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
  uint count;  // of the poses, from the launch
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

#endif
