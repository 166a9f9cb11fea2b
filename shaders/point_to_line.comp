#version 450
#extension GL_GOOGLE_include_directive : require
// Points on the lines of another scan (engine/compute/kernels/point_to_line/point_to_line.hpp): a group a pair of scans.
// Its invocations are the lanes of the sums.

#include "common/launch.glsl"
#include "common/reciprocal.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Values { float values[]; };
layout(set = 0, binding = 1, std430) readonly buffer Bins { uint bins[]; };  // two bins each

struct Pose {
  float x;
  float y;
  float s;
  float c;
};

struct Pair {
  Pose found;
  Pose at;
  float low;
  float high;
  uint fixed_begin;
  uint fixed_count;
  uint bins;
  uint moving_begin;
  uint moving_count;
  uint every;
  uint taken;
};

layout(set = 0, binding = 2, std430) readonly buffer Pairs { Pair pairs[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Sums { float sums[]; };

layout(push_constant) uniform Params {
  float gate_m2;
  float per_kernel_m2;
  float least_cosine;
  uint count;  // number of pairs, from the launch
} params;

const uint kLanes = 32u;  // and the size of a group
const uint kSums = 11u;
const uint kCandidates = 16u;
const uint kBefore = 6u;
const float kLeastLength = 1.0e-18;

shared float lane_sums[kSums * kLanes];

vec2 placed(Pose pose, vec2 point) {
  precise float x = (pose.c * point.x - pose.s * point.y) + pose.x;
  precise float y = (pose.s * point.x + pose.c * point.y) + pose.y;
  return vec2(x, y);
}

float direction_of(vec2 place) {
  precise float sum = abs(place.x) + abs(place.y);
  precise float share = place.y * reciprocal(sum > kLeastLength ? sum : 1.0);
  precise float behind = (place.y < 0.0 ? -2.0 : 2.0) - share;
  return place.x >= 0.0 ? share : behind;
}

/// The first surface point in the direction's bin or after it.
uint first_in_bin(Pair pair, float direction) {
  precise float bin = (direction + 2.0) * 64.0;
  float above = bin > 0.0 ? bin : 0.0;
  uint index = pair.bins + uint(int(above < 255.0 ? above : 255.0));
  return (bins[index >> 1] >> ((index & 1u) << 4)) & 0xFFFFu;
}

/// The surface point nearest to a place, if it is a candidate within the gate and in view; else fixed_count.
uint nearest_line(Pair pair, vec2 place) {
  float direction = direction_of(place);
  uint first = first_in_bin(pair, direction);
  uint start = min(first > kBefore ? first - kBefore : 0u, pair.fixed_count - kCandidates);
  uint least = 0xFFFFFFFFu;
  for (uint k = 0u; k < kCandidates; ++k) {
    uint at = pair.fixed_begin + start + k;
    precise float dx = values[at] - place.x;
    precise float dy = values[at + pair.fixed_count] - place.y;
    precise float square = dx * dx + dy * dy;
    least = min(least, (floatBitsToUint(square) & ~15u) + k);
  }
  bool is_seen = direction >= pair.low && direction <= pair.high;
  return is_seen && least < floatBitsToUint(params.gate_m2) ? start + (least & 15u) : pair.fixed_count;
}

void add_point(Pair pair, uint number, inout float own[kSums]) {
  uint at = pair.moving_begin + number * pair.every;
  vec2 point = vec2(values[at], values[at + pair.moving_count]);
  vec2 normal = vec2(values[at + 2u * pair.moving_count], values[at + 3u * pair.moving_count]);
  uint line = nearest_line(pair, placed(pair.found, point));
  if (line == pair.fixed_count) return;
  uint on = pair.fixed_begin + line;
  float nx = values[on + 2u * pair.fixed_count];
  float ny = values[on + 3u * pair.fixed_count];
  vec2 place = placed(pair.at, point);
  precise float off = nx * (place.x - values[on]) + ny * (place.y - values[on + pair.fixed_count]);
  precise float jx = pair.at.c * nx + pair.at.s * ny;
  precise float jy = pair.at.c * ny - pair.at.s * nx;
  precise float jt = point.x * jy - point.y * jx;
  precise float cosine = jx * normal.x + jy * normal.y;
  if (!(cosine >= params.least_cosine)) return;
  precise float spread = 1.0 + (off * off) * params.per_kernel_m2;
  float share = reciprocal(spread);
  precise float weight = share * share;
  precise float pull = weight * off;
  precise float wx = weight * jx;
  precise float wy = weight * jy;
  precise float terms[kSums] = float[kSums](wx * jx, wx * jy, wx * jt, wy * jy, wy * jt, (weight * jt) * jt, pull * jx,
                                            pull * jy, pull * jt, weight, pull * off);
  for (uint k = 0u; k < kSums; ++k) {
    precise float sum = own[k] + terms[k];
    own[k] = sum;
  }
}

void main() {
  uint index = linear_group();
  if (index >= params.count) {
    return;  // the whole group
  }
  uint lane = gl_LocalInvocationID.x;
  Pair pair = pairs[index];
  float own[kSums] = float[kSums](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  for (uint number = lane; number < pair.taken; number += kLanes) add_point(pair, number, own);
  for (uint k = 0u; k < kSums; ++k) lane_sums[k * kLanes + lane] = own[k];
  for (uint half_count = kLanes / 2u; half_count > 0u; half_count /= 2u) {
    barrier();
    if (lane < half_count) {
      for (uint k = 0u; k < kSums; ++k) {
        precise float sum = lane_sums[k * kLanes + lane] + lane_sums[k * kLanes + lane + half_count];
        lane_sums[k * kLanes + lane] = sum;
      }
    }
  }
  barrier();
  if (lane < kSums) sums[index * kSums + lane] = lane_sums[lane * kLanes];
}
