#version 450
#extension GL_GOOGLE_include_directive : require
// choose_pose (engine/compute/kernels/pose_simplex/pose_simplex.hpp, ChoosePose) in one pass over the points: each
// invocation takes one pose and a share of the points, and adds up all that may be asked about that pose, both sums of
// its cost included, for who votes is known only when pose 0 has seen all points. One invocation then decides.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

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

layout(set = 0, binding = 2, std430) readonly buffer Poses { PolishedPose poses[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Verdict {
  float x;
  float y;
  float theta;
  uint cost;
  uint chosen;
  uint evaluations;
  uint stop;
  uint sum;
  uint near;
  uint beside;
  uint known;
  uint voters;
  uint local_cost;
} verdict;

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
  uint pose_count;
  uint map_cap;
  uint gate;
  uint contradiction_q16;
  uint overlap_q16;
  uint leap_q8;
  float far_sq_cells;
  float far_rad;
} params;

#include "common/launch.glsl"
#include "common/field_lookup.glsl"
#include "common/prior.glsl"

const uint kMostPoses = 17u;  // SmallestValues::kMost + 1

// State of each pose.
shared uint cost_of_all[kMostPoses];
shared uint cost_of_voters[kMostPoses];
shared uint nearest_sum[kMostPoses];
shared uint near_points[kMostPoses];
shared uint beside_points[kMostPoses];
shared uint known_points[kMostPoses];
shared uint voter_points[kMostPoses];  // the same for each

vec3 pose_at(uint i) { return vec3(poses[i].x, poses[i].y, poses[i].theta); }

/// Adds the points first, first + step, ... to what is known of a pose.
void add_points(uint pose_index, uint first, uint step_width) {
  FieldView view = field_view(params.width, params.height, params.stride, params.strip, params.blank,
                              params.anchor_x, params.anchor_y);
  uint square_shift = squared_shift(params.cap);
  vec3 pose = pose_at(pose_index);
  vec3 local_pose = pose_at(0u);
  CellRotation rotation = cell_rotation(pose.z);
  CellRotation local_rotation = cell_rotation(local_pose.z);
  uint all = 0u;
  uint voters_cost = 0u;
  uint nearest = 0u;
  uint near = 0u;
  uint beside = 0u;
  uint known = 0u;
  uint voters = 0u;
  for (uint i = first; i < params.point_count; i += step_width) {
    vec2 point = points[i];
    uint local_value = nearest_value(view, point_position(view, local_rotation, local_pose.xy, point));
    uint vote = local_value < min(params.cap, params.map_cap) ? 1u : 0u;
    ivec2 position = point_position(view, rotation, pose.xy, point);
    uint value = nearest_value(view, position);
    uint cost_value = params.interpolation == kBilinear ? bilinear_value(view, position) : value;
    uint term = cost_term(cost_value, params.cap, params.form, square_shift);
    all += term;
    voters_cost += term * vote;
    voters += vote;
    nearest += min(value, params.cap);
    near += value <= params.gate ? 1u : 0u;
    beside += value > 2u * params.gate && value < params.map_cap ? 1u : 0u;
    known += value < params.map_cap ? 1u : 0u;
  }
  atomicAdd(cost_of_all[pose_index], all);
  atomicAdd(cost_of_voters[pose_index], voters_cost);
  atomicAdd(nearest_sum[pose_index], nearest);
  atomicAdd(near_points[pose_index], near);
  atomicAdd(beside_points[pose_index], beside);
  atomicAdd(known_points[pose_index], known);
  atomicAdd(voter_points[pose_index], voters);
}

/// Products of two factors up to 65536, one of them less, fit.
bool is_suspect() {
  return beside_points[0] * 65536u > params.contradiction_q16 * known_points[0] ||
         near_points[0] * 65536u < params.overlap_q16 * params.point_count;
}

bool is_far(vec3 pose) {
  precise float dx = pose.x - params.mean_x;
  precise float dy = pose.y - params.mean_y;
  precise float dt = pose.z - params.mean_theta;
  precise float sq_distance = dx * dx + dy * dy;
  return sq_distance > params.far_sq_cells || abs(dt) > params.far_rad;
}

/// (cost * leap_q8) >> 8, at most 2^32 - 1.
uint raised(uint cost) {
  uint high;
  uint low;
  umulExtended(cost, params.leap_q8, high, low);
  return high > 255u ? 0xFFFFFFFFu : (high << 24) | (low >> 8);
}

void decide() {
  Prior prior = Prior(vec3(params.mean_x, params.mean_y, params.mean_theta), params.weight_xy, params.weight_theta,
                      params.limit);
  bool all_vote = is_suspect();
  bool leap_costs = params.leap_q8 != 0u && !is_far(pose_at(0u));
  uint best = 0u;
  uint best_cost = 0u;
  uint evaluations = 0u;
  for (uint i = 0u; i < params.pose_count; ++i) {
    vec3 pose = pose_at(i);
    uint cost = saturating_add(all_vote ? cost_of_all[i] : cost_of_voters[i], prior_cost(prior, pose));
    if (i == 0u) {
      verdict.local_cost = cost;
    } else if (leap_costs && is_far(pose)) {
      cost = raised(cost);
    }
    bool better = i == 0u || cost < best_cost;
    best = better ? i : best;
    best_cost = better ? cost : best_cost;
    evaluations += poses[i].evaluations;
  }
  verdict.x = poses[best].x;
  verdict.y = poses[best].y;
  verdict.theta = poses[best].theta;
  verdict.cost = best_cost;
  verdict.chosen = best;
  verdict.evaluations = evaluations;
  verdict.stop = poses[best].stop;
  verdict.sum = nearest_sum[best];
  verdict.near = near_points[best];
  verdict.beside = beside_points[best];
  verdict.known = known_points[best];
  verdict.voters = all_vote ? params.point_count : voter_points[best];
}

void main() {
  uint self = gl_LocalInvocationID.x;
  for (uint i = self; i < kMostPoses; i += gl_WorkGroupSize.x) {
    cost_of_all[i] = 0u;
    cost_of_voters[i] = 0u;
    nearest_sum[i] = 0u;
    near_points[i] = 0u;
    beside_points[i] = 0u;
    known_points[i] = 0u;
    voter_points[i] = 0u;
  }
  barrier();
  // Few invocations take several poses each, many share one.
  uint share = max(gl_WorkGroupSize.x / params.pose_count, 1u);
  for (uint pose = self / share; pose < params.pose_count; pose += gl_WorkGroupSize.x / share) {
    add_points(pose, self % share, share);
  }
  barrier();
  if (self == 0u) {
    decide();
  }
}
