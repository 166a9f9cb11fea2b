#version 450
#extension GL_GOOGLE_include_directive : require
// Descents along the slope (engine/compute/kernels/pose_descent/pose_descent.hpp, PoseDescent): a group a pose. Its
// invocations are the lanes of the sums; all of them walk, each with the same bits.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

#include "common/launch.glsl"
#include "common/field_lookup.glsl"
#include "common/reciprocal.glsl"

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
layout(set = 0, binding = 3, std430) writeonly buffer Values { uint values[]; };  // two points each

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
  float first_width;
  float narrowing;
  float last_width;
  float stop_cells;
  float stop_rad;
  uint max_evaluations;
  uint count;  // number of poses, from the launch
} params;

const uint kLanes = 64u;  // and the size of a group
const float kFirstDamping = 1.0e-4;
const float kMostDamping = 1000.0;
const float kLeastPivot = 1.0e-20;
const float kLoose = 8.0;

/// Cost and gradient; curvatures xx, xy, xt, yy; yt, tt.
struct Slope {
  vec4 cost_x_y_t;
  vec4 xx_xy_xt_yy;
  vec2 yt_tt;
};

shared vec4 lane_cost[kLanes];
shared vec4 lane_curve[kLanes];
shared vec2 lane_turn[kLanes];

struct Gate {
  float width;
  float per_width;
  float most;
};

Gate gate_of(float width) {
  precise float most = (width * width) * (1.0 / 1536.0);
  return Gate(width, reciprocal(width), most);
}

/// The largest whole number not above a clamped position; NaN counts as -2^30.
float floor_position(float position) {
  float above = position > -1073741824.0 ? position : -1073741824.0;
  return float(int(floor(above < 1073741824.0 ? above : 1073741824.0)));
}

/// A coordinate of the grid, held between 0 and the last cell.
float held_cell(float wanted, float last) {
  float above = wanted > 0.0 ? wanted : 0.0;
  return above < last ? above : last;
}

void add_point(CellRotation r, vec3 pose, Gate gate, vec2 point, inout Slope own) {
  precise float x = r.c * point.x - r.s * point.y;
  precise float y = r.s * point.x + r.c * point.y;
  precise float u = (x + pose.x) - 0.5;
  precise float v = (y + pose.y) - 0.5;
  float floor_u = floor_position(u);
  float floor_v = floor_position(v);
  precise float wanted_x = floor_u + float(params.anchor_x);
  precise float wanted_y = floor_v + float(params.anchor_y);
  float held_x = held_cell(wanted_x, float(params.width - 2u));
  float held_y = held_cell(wanted_y, float(params.height - 2u));
  precise float inside_x = u - floor_u;
  precise float inside_y = v - floor_v;
  float fx = held_x == wanted_x ? inside_x : 0.0;
  float fy = held_y == wanted_y ? inside_y : 0.0;
  uint cell = field_place(uint(int(held_x)), uint(int(held_y)), params.stride, params.strip);
  uint blank = params.blank << 16 | params.blank;
  uint lower = cell_pair(cell) ^ blank;
  uint upper = cell_pair(cell + params.stride) ^ blank;
  float v00 = float(lower & 0xFFFFu);
  float v10 = float(lower >> 16);
  float v01 = float(upper & 0xFFFFu);
  float v11 = float(upper >> 16);
  precise float bottom = v00 + fx * (v10 - v00);
  precise float top = v01 + fx * (v11 - v01);
  precise float left = v00 + fy * (v01 - v00);
  precise float right = v10 + fy * (v11 - v10);
  precise float between = bottom + fy * (top - bottom);
  float cap = float(params.cap);
  float slopes = between < cap ? 1.0 : 0.0;
  float value = between < cap ? between : cap;
  precise float gx = slopes * (right - left);
  precise float gy = slopes * (top - bottom);
  precise float gt = gy * x - gx * y;
  precise float share = value * gate.per_width;
  float held = share < 1.0 ? share : 1.0;
  precise float q = 1.0 - held * held;
  precise float weight = (q * q) * (1.0 / 256.0);
  precise float robust = gate.most * (1.0 - (q * q) * q);
  precise float pull = weight * value;
  precise float wx = weight * gx;
  precise float wy = weight * gy;
  precise vec4 cost = own.cost_x_y_t + vec4(robust, pull * gx, pull * gy, pull * gt);
  precise vec4 curve = own.xx_xy_xt_yy + vec4(wx * gx, wx * gy, wx * gt, wy * gy);
  precise vec2 turn = own.yt_tt + vec2(wy * gt, (weight * gt) * gt);
  own = Slope(cost, curve, turn);
}

/// Sums of all points, the same for each invocation.
Slope sum_points(vec3 pose, Gate gate) {
  uint lane = gl_LocalInvocationID.x;
  CellRotation rotation = cell_rotation(pose.z);
  Slope own = Slope(vec4(0.0), vec4(0.0), vec2(0.0));
  for (uint i = lane; i < params.point_count; i += kLanes) {
    add_point(rotation, pose, gate, points[i], own);
  }
  barrier();  // all have read the sums before
  lane_cost[lane] = own.cost_x_y_t;
  lane_curve[lane] = own.xx_xy_xt_yy;
  lane_turn[lane] = own.yt_tt;
  for (uint half_count = kLanes / 2u; half_count > 0u; half_count /= 2u) {
    barrier();
    if (lane < half_count) {
      precise vec4 cost = lane_cost[lane] + lane_cost[lane + half_count];
      precise vec4 curve = lane_curve[lane] + lane_curve[lane + half_count];
      precise vec2 turn = lane_turn[lane] + lane_turn[lane + half_count];
      lane_cost[lane] = cost;
      lane_curve[lane] = curve;
      lane_turn[lane] = turn;
    }
  }
  barrier();
  return Slope(lane_cost[0], lane_curve[0], lane_turn[0]);
}

/// The prior as in prior_cost(), not cut, with its gradient.
void add_prior(vec3 pose, inout Slope at) {
  precise float dx = pose.x - params.mean_x;
  precise float dy = pose.y - params.mean_y;
  precise float dt = pose.z - params.mean_theta;
  precise float shift = (dx * dx + dy * dy) * params.weight_xy;
  precise float turn = (dt * dt) * params.weight_theta;
  precise float twice_xy = 2.0 * params.weight_xy;
  precise float twice_t = 2.0 * params.weight_theta;
  float pull_xy = shift < params.limit ? twice_xy : 0.0;
  float pull_t = turn < params.limit ? twice_t : 0.0;
  float shift_cost = shift < params.limit ? shift : params.limit;
  float turn_cost = turn < params.limit ? turn : params.limit;
  precise vec4 cost = at.cost_x_y_t + vec4(shift_cost + turn_cost, pull_xy * dx, pull_xy * dy, pull_t * dt);
  precise float xx = at.xx_xy_xt_yy.x + pull_xy;
  precise float yy = at.xx_xy_xt_yy.w + pull_xy;
  precise float tt = at.yt_tt.y + pull_t;
  at = Slope(cost, vec4(xx, at.xx_xy_xt_yy.y, at.xx_xy_xt_yy.z, yy), vec2(at.yt_tt.x, tt));
}

/// The damped step; false if the matrix is singular.
bool damped_step(Slope at, float damping, out vec3 taken) {
  taken = vec3(0.0);
  precise float grow = 1.0 + damping;
  precise float d0 = at.xx_xy_xt_yy.x * grow;
  float r0 = reciprocal(d0);
  precise float l1 = at.xx_xy_xt_yy.y * r0;
  precise float l2 = at.xx_xy_xt_yy.z * r0;
  precise float d1 = at.xx_xy_xt_yy.w * grow - l1 * at.xx_xy_xt_yy.y;
  float r1 = reciprocal(d1);
  precise float rest = at.yt_tt.x - l2 * at.xx_xy_xt_yy.y;
  precise float l3 = rest * r1;
  precise float d2 = (at.yt_tt.y * grow - l2 * at.xx_xy_xt_yy.z) - l3 * rest;
  if (!(d0 > kLeastPivot) || !(d1 > kLeastPivot) || !(d2 > kLeastPivot)) return false;
  precise float u0 = -at.cost_x_y_t.y;
  precise float u1 = -at.cost_x_y_t.z - l1 * u0;
  precise float u2 = (-at.cost_x_y_t.w - l2 * u0) - l3 * u1;
  precise float theta = u2 * reciprocal(d2);
  precise float y = u1 * r1 - l3 * theta;
  precise float x = (u0 * r0 - l1 * y) - l2 * theta;
  taken = vec3(x, y, theta);
  return true;
}

float more_damping(float damping) {
  precise float four_times = 4.0 * damping;
  return damping < 0.25 ? 1.0 : four_times;
}

/// A descent between two evaluations.
struct Walk {
  vec3 pose;
  Slope here;
  vec3 next;  // to be evaluated
  bool enters;  // a new width, at the pose itself
  Gate gate;
  float damping;
  uint evaluations;
  uint stop;
};

bool is_last(Walk walk) { return !(walk.gate.width > params.last_width); }

bool is_small(Walk walk, vec3 taken) {
  precise float cells = (is_last(walk) ? 1.0 : kLoose) * params.stop_cells;
  precise float angle = (is_last(walk) ? 1.0 : kLoose) * params.stop_rad;
  return abs(taken.x) < cells && abs(taken.y) < cells && abs(taken.z) < angle;
}

void enter(inout Walk walk, float width) {
  walk.gate = gate_of(width > params.last_width ? width : params.last_width);
  walk.next = walk.pose;
  walk.enters = true;
}

/// Takes the slope at `next`.
void take(inout Walk walk, Slope there) {
  walk.evaluations += 1u;
  if (walk.enters) {
    walk.damping = kFirstDamping;
    walk.here = there;
  } else if (there.cost_x_y_t.x < walk.here.cost_x_y_t.x) {
    walk.pose = walk.next;
    walk.here = there;
  } else {
    walk.damping = more_damping(walk.damping);
  }
}

/// Goes on to the next pose to be evaluated, or stops.
void go_on(inout Walk walk) {
  vec3 taken;
  bool regular = damped_step(walk.here, walk.damping, taken);
  while (!regular && !(walk.damping > kMostDamping)) {
    walk.damping = more_damping(walk.damping);
    regular = damped_step(walk.here, walk.damping, taken);
  }
  bool leaves = walk.damping > kMostDamping || is_small(walk, taken);
  if (leaves && is_last(walk)) {
    walk.stop = 1u;
  } else if (walk.evaluations >= params.max_evaluations) {
    walk.stop = 2u;
  } else if (leaves) {
    precise float width = walk.gate.width * params.narrowing;
    enter(walk, width);
  } else {
    precise vec3 next = walk.pose + taken;
    walk.next = next;
    walk.enters = false;
  }
}

/// The field at a point's nearest cell, as in point_values.hpp.
uint value_under(CellRotation r, vec3 pose, vec2 point) {
  precise float u = (r.c * point.x - r.s * point.y) + pose.x;
  precise float v = (r.s * point.x + r.c * point.y) + pose.y;
  precise float x = floor_position(u) + float(params.anchor_x);
  precise float y = floor_position(v) + float(params.anchor_y);
  uint cell = field_place(uint(int(held_cell(x, float(params.width - 1u)))),
                          uint(int(held_cell(y, float(params.height - 1u)))), params.stride, params.strip);
  return ((field[cell >> 1] >> ((cell & 1u) << 4)) & 0xFFFFu) ^ params.blank;
}

void store_values(uint index, vec3 pose) {
  CellRotation rotation = cell_rotation(pose.z);
  uint words = (params.point_count + 1u) / 2u;
  for (uint word = gl_LocalInvocationID.x; word < words; word += kLanes) {
    uint last = min(2u * word + 1u, params.point_count - 1u);
    uint first_value = value_under(rotation, pose, points[2u * word]);
    uint second_value = value_under(rotation, pose, points[last]);
    values[index * words + word] = first_value | (last == 2u * word ? 0u : second_value) << 16;
  }
}

void main() {
  uint index = linear_group();
  if (index >= params.count) {
    return;  // the whole group
  }
  vec3 start = vec3(poses[index].x, poses[index].y, poses[index].theta);
  Walk walk = Walk(start, Slope(vec4(0.0), vec4(0.0), vec2(0.0)), start, true, gate_of(1.0), kFirstDamping, 0u, 0u);
  enter(walk, params.first_width);
  while (walk.stop == 0u) {
    Slope there = sum_points(walk.next, walk.gate);
    add_prior(walk.next, there);
    take(walk, there);
    go_on(walk);
  }
  store_values(index, walk.pose);
  if (gl_LocalInvocationID.x == 0u) {
    float cost = walk.here.cost_x_y_t.x;
    poses[index].x = walk.pose.x;
    poses[index].y = walk.pose.y;
    poses[index].theta = walk.pose.z;
    poses[index].cost = uint(int(cost < 2.0e9 ? cost : 2.0e9));
    poses[index].evaluations += walk.evaluations;
    poses[index].stop = walk.stop;
  }
}
