// Squared distances to field cells, by table. An invocation turns four cells of one or more rows.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint table_size;
};
layout(set = 0, binding = 0, std430) readonly buffer SqDistance { uvec2 sq_distance[]; };
layout(set = 0, binding = 1, std430) readonly buffer Table { uint table[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Field { uvec2 field[]; };

uint entry(uint sq) {
  uint index = min(sq, table_size - 1);
  return (table[index >> 1] >> ((index & 1u) << 4)) & 0xFFFFu;
}

void main() {
  uint quad = gl_GlobalInvocationID.x;
  if (quad >= (width + 3) / 4) {
    return;
  }
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    uint at = y * (stride / 4) + quad;
    uvec4 sq = unpack_cells(sq_distance[at]);
    field[at] = pack_cells(uvec4(entry(sq.x), entry(sq.y), entry(sq.z), entry(sq.w)));
  }
}
