// Jump flooding, first pass: a seed is its own nearest. An invocation does four cells of one or more rows.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/jump_flood.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
};
layout(set = 0, binding = 0, std430) readonly buffer Seeds { uint seeds[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Nearest { uvec4 nearest[]; };

void main() {
  uint quad = gl_GlobalInvocationID.x;
  if (quad >= (width + 3) / 4) {
    return;
  }
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    uint at = y * (stride / 4) + quad;
    uvec4 own = (y << 16 | quad * 4) + uvec4(0, 1, 2, 3);
    bvec4 is_seed = notEqual(unpack_bytes(seeds[at]), uvec4(0));
    nearest[at] = mix(uvec4(kNoSeed), own, is_seed);
  }
}
