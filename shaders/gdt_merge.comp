// Merge of a scan's field into the global one, paper equations (9) to (11). An invocation does four cells of the global
// field, two words, of one or more rows; cells of these words that lie beside the scan's field are written back as they
// were. No other invocation writes them, as rows begin at a multiple of four cells.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(push_constant) uniform Params {
  uint scan_width;
  uint scan_height;
  uint scan_stride;
  uint global_stride;
  uint offset_x;
  uint offset_y;
  uint threshold;
  uint lift;
  uint cap;
  uint rule;
  uint global_strip;
  uint blank;
};
layout(set = 0, binding = 0, std430) buffer Global { uvec2 global_field[]; };
layout(set = 0, binding = 1, std430) readonly buffer Scan { uvec2 scan_field[]; };

#include "common/field_layout.glsl"
#include "common/merge_rule.glsl"

// The scan's cells at columns x to x + 3 of row y, where x may lie outside; the cells outside of it are unknown.
uvec4 scan_cells(int x, uint y) {
  int last = int((scan_width - 1) / 4);
  int quad = x >> 2;
  uint row = y * (scan_stride / 4);
  uvec4 low = unpack_cells(scan_field[row + uint(clamp(quad, 0, last))]);
  uvec4 high = unpack_cells(scan_field[row + uint(clamp(quad + 1, 0, last))]);
  int turn = x & 3;  // the same for all cells of a launch
  uvec4 by_one_or_two = turn == 1 ? uvec4(low.yzw, high.x) : uvec4(low.zw, high.xy);
  uvec4 cells = turn == 0 ? low : turn == 3 ? uvec4(low.w, high.xyz) : by_one_or_two;
  return mix(uvec4(0xFFFFu), cells, lessThan(uvec4(x + ivec4(0, 1, 2, 3)), uvec4(scan_width)));
}

void main() {
  uint quad = offset_x / 4 + gl_GlobalInvocationID.x;
  if (quad > (offset_x + scan_width - 1) / 4) {
    return;
  }
  int x = int(quad * 4) - int(offset_x);
  for (uint y = gl_GlobalInvocationID.y; y < scan_height; y += launch_rows()) {
    uint at = field_place(quad * 4, offset_y + y, global_stride, global_strip) / 4;
    uvec4 cells = merged(unpack_cells(global_field[at]) ^ blank, scan_cells(x, y)) ^ blank;
    global_field[at] = pack_cells(cells);
    // The first cell of a strip's row is the 65th of the strip before, in words that nobody else writes.
    if (global_strip != kStripWidth && quad > 0 && quad % (kStripWidth / 4) == 0) {
      uint before = at - (global_strip - kStripWidth) / 4;
      global_field[before].x = (global_field[before].x & 0xFFFF0000u) | cells.x;
    }
  }
}
