// Truncated distance transform, rows. An invocation does two cells, one word of the result: it searches outwards on
// both sides until neither can become smaller.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Distance { uint column_distance[]; };
layout(set = 0, binding = 1, std430) writeonly buffer SqDistance { uint sq_distance[]; };

// Square of the cell's column distance; R*R outside of the row.
uint square_at(uint row, uint x) {
  if (x >= width) {
    return radius * radius;
  }
  uint cell = row + x;
  uint distance = (column_distance[cell / 4] >> (cell % 4) * 8) & 0xFFu;
  return distance * distance;
}

void main() {
  uint x = gl_GlobalInvocationID.x * 2;
  if (x >= width) {
    return;
  }
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    uint row = y * stride;
    uvec2 best = uvec2(square_at(row, x), square_at(row, x + 1));
    uvec2 left = best;
    uvec2 right = best;
    for (uint offset = 1; offset < radius; ++offset) {
      uint sq = offset * offset;
      if (sq >= max(best.x, best.y)) {
        break;
      }
      left = uvec2(square_at(row, x - offset), left.x);  // left of column 0 is beyond the width, modulo 2^32
      right = uvec2(right.y, square_at(row, x + 1 + offset));
      best = min(best, min(left, right) + sq);
    }
    sq_distance[(row + x) / 2] = pack_pair(best);
  }
}
