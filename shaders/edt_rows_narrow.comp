// Truncated distance transform, rows. An invocation does eight cells of one or more rows: it searches outwards on both
// sides, four offsets a step, in squares that it holds in registers, until no cell can become smaller.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Distance { uint column_distance[]; };
layout(set = 0, binding = 1, std430) writeonly buffer SqDistance { uvec2 sq_distance[]; };

// Squares of the four cells from `x` on of a row that begins at word `row`; R*R outside of it.
uvec4 squares_at(uint row, int x) {
  ivec4 cells = x + ivec4(0, 1, 2, 3);
  bool is_in_row = x >= 0 && x < int(width);
  uvec4 distance = unpack_bytes(column_distance[row + (is_in_row ? uint(x) / 4 : 0)]);
  bvec4 counts = lessThan(uvec4(cells), uvec4(width));  // a negative one is a large one
  return mix(uvec4(radius), distance, counts) * mix(uvec4(radius), distance, counts);
}

uvec4 lesser(uvec4 best, uvec4 left, uvec4 right, uint offset) { return min(best, min(left, right) + offset * offset); }

void search_tile(uint y, uint x) {
  uint row = y * (stride / 4);
  uvec4 best0 = squares_at(row, int(x));
  uvec4 best1 = squares_at(row, int(x) + 4);
  // Left of the tile and from its first cell on: twelve cells on each side, which move away from each other.
  uvec4 l0 = squares_at(row, int(x) - 4);
  uvec4 l1 = best0;
  uvec4 l2 = best1;
  uvec4 r0 = best0;
  uvec4 r1 = best1;
  uvec4 r2 = squares_at(row, int(x) + 8);
  for (uint step = 0; step < radius; step += 4) {
    uint nearest = (step + 1) * (step + 1);
    uvec4 most = max(best0, best1);
    if (nearest >= max(max(most.x, most.y), max(most.z, most.w))) {
      break;
    }
    best0 = lesser(best0, uvec4(l0.w, l1.xyz), uvec4(r0.yzw, r1.x), step + 1);
    best1 = lesser(best1, uvec4(l1.w, l2.xyz), uvec4(r1.yzw, r2.x), step + 1);
    best0 = lesser(best0, uvec4(l0.zw, l1.xy), uvec4(r0.zw, r1.xy), step + 2);
    best1 = lesser(best1, uvec4(l1.zw, l2.xy), uvec4(r1.zw, r2.xy), step + 2);
    best0 = lesser(best0, uvec4(l0.yzw, l1.x), uvec4(r0.w, r1.xyz), step + 3);
    best1 = lesser(best1, uvec4(l1.yzw, l2.x), uvec4(r1.w, r2.xyz), step + 3);
    best0 = lesser(best0, l0, r1, step + 4);
    best1 = lesser(best1, l1, r2, step + 4);
    l2 = l1;
    l1 = l0;
    l0 = squares_at(row, int(x) - int(step) - 8);
    r0 = r1;
    r1 = r2;
    r2 = squares_at(row, int(x) + int(step) + 12);
  }
  uint at = y * (stride / 4) + x / 4;
  sq_distance[at] = pack_cells(best0);
  if (x + 4 < width) {
    sq_distance[at + 1] = pack_cells(best1);
  }
}

void main() {
  uint x = gl_GlobalInvocationID.x * 8;
  if (x >= width) {
    return;
  }
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    search_tile(y, x);
  }
}
