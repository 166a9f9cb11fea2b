// Bounds of tiles of boxes, a work group a tile: its invocations say where a block of points begins to read, one each, and
// then share the reading out, four bytes of a row and a part of the points each. The sums are of integers, so how they
// are shared out does not matter.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/pose_bounds.glsl"

const uint kMostInvocations = 128;
struct Point {
  float x;
  float y;
  uint dilation;
};
layout(set = 0, binding = 1, std430) readonly buffer Points { Point points[]; };
shared uint begin_of[kMostInvocations];
shared uvec4 sum_of[kMostInvocations];

void main() {
  uint own = gl_LocalInvocationID.x;
  uint tile = linear_group();
  bool is_in_launch = tile < count;  // the same for the whole group
  uint to_do = is_in_launch ? point_count : 0u;
  Looking looking = looking_from(tiles[is_in_launch ? tile : 0u]);
  // Of the words of a tile, four bytes each, an invocation reads one under every so many points.
  uint row_words = kIsWide == 1u ? 4u : 1u;
  uint used = kIsWide == 1u ? 4u : 2u;
  uint words = row_words * (kIsWide == 1u ? 4u : 2u);
  uint word = own % words;
  uint share = own / words;
  uint shares = gl_WorkGroupSize.x / words;
  uint offset = (word / row_words) * width + (word % row_words) * 4u;
  uvec4 sum = uvec4(0u);
  for (uint first = 0u; first < to_do; first += gl_WorkGroupSize.x) {
    uint in_block = min(gl_WorkGroupSize.x, to_do - first);
    if (own < in_block) {
      Point point = points[first + own];
      begin_of[own] = first_byte(looking, vec2(point.x, point.y), point.dilation);
    }
    barrier();
    uvec2 pairs = uvec2(0u);
    for (uint i = share; i < in_block; i += shares) {
      pairs += pairs_of(four_bytes(begin_of[i] + offset, used));
    }
    sum += bytes_of(pairs);
    barrier();
  }
  sum_of[own] = sum;
  for (uint half_size = gl_WorkGroupSize.x / 2u; half_size >= words; half_size /= 2u) {
    barrier();
    if (own < half_size) {
      sum_of[own] += sum_of[own + half_size];
    }
  }
  barrier();
  if (kIsWide == 1u) {
    if (own < words && is_in_launch) {
      sums[words * tile + own] = sum_of[own];
    }
  } else if (own == 0u && is_in_launch) {
    sums[tile] = uvec4(sum_of[0].xy, sum_of[1].xy);
  }
}
