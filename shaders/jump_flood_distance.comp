// Jump flooding, last step: squared distance to the nearest seed, truncated at R*R. An invocation does four cells of one or more rows.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/jump_flood.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint radius;
};

layout(set = 0, binding = 0, std430) readonly buffer Nearest { uvec4 nearest[]; };
layout(set = 0, binding = 1, std430) writeonly buffer SqDistance { uvec2 sq_distance[]; };

void main() {
  uint quad = gl_GlobalInvocationID.x;
  if (quad >= (width + 3) / 4) {
    return;
  }
  uint x = quad * 4;
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    uint at = y * (stride / 4) + quad;
    uvec4 seed = nearest[at];
    uvec4 sq = uvec4(sq_distance_to(seed.x, x, y), sq_distance_to(seed.y, x + 1, y),
                     sq_distance_to(seed.z, x + 2, y), sq_distance_to(seed.w, x + 3, y));
    sq_distance[at] = pack_cells(min(sq, uvec4(radius * radius)));
  }
}
