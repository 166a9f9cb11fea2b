#version 450
#extension GL_GOOGLE_include_directive : require
// A field moved into a larger one (engine/compute/kernels/gdt_merge/gdt_merge.hpp, FieldGrow), a word of two cells an
// invocation.

layout(set = 0, binding = 0, std430) readonly buffer OldField { uint old_field[]; };
layout(set = 0, binding = 1, std430) writeonly buffer NewField { uint new_field[]; };

layout(push_constant) uniform Params {
  uint old_width;
  uint old_height;
  uint old_stride;
  uint width;
  uint height;
  uint stride;
  uint offset_x;
  uint offset_y;
  uint cap;
} params;

#include "common/launch.glsl"

/// The cell of the new field in column x; `old_row` is the first cell of the old row, which exists if `crosses`. Every
/// invocation reads, cell 0 for want of another: cheaper than a branch where they run in lockstep.
uint cell_at(bool crosses, uint old_row, uint x) {
  uint old_x = x - params.offset_x;  // beyond the width when x lies before the offset
  bool inside = crosses && old_x < params.old_width;
  uint cell = inside ? old_row + old_x : 0u;
  uint value = old_field[cell >> 1] >> ((cell & 1u) << 4);
  return (inside ? value : params.cap) & 0xFFFFu;
}

void main() {
  uint words = (params.width + 1u) >> 1;
  uint place = linear_invocation();
  uint y = place / words;
  if (y >= params.height) {
    return;
  }
  uint word = place - y * words;
  uint old_y = y - params.offset_y;
  bool crosses = old_y < params.old_height;
  uint left = cell_at(crosses, old_y * params.old_stride, 2u * word);
  uint right = cell_at(crosses, old_y * params.old_stride, 2u * word + 1u);
  new_field[((y * params.stride) >> 1) + word] = left | (right << 16);
}
