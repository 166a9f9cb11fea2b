// Truncated distance transform, columns. An invocation sweeps four columns, one word, down and up the whole grid.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Seeds { uint seeds[]; };
layout(set = 0, binding = 1, std430) buffer Distance { uint column_distance[]; };

void main() {
  uint word = gl_GlobalInvocationID.x;
  if (word >= (width + 3) / 4) {
    return;
  }
  uint row = stride / 4;
  uint limit = radius;
  uvec4 distance = uvec4(limit);
  uint end = height * row + word;
  for (uint at = word; at < end; at += row) {
    bvec4 is_seed = notEqual(unpack_bytes(seeds[at]), uvec4(0));
    distance = mix(min(distance + 1, uvec4(limit)), uvec4(0), is_seed);
    column_distance[at] = pack_bytes(distance);
  }
  for (uint at = end - row; at >= row; at -= row) {
    uint above = at - row;
    distance = min(unpack_bytes(column_distance[above]), distance + 1);
    column_distance[above] = pack_bytes(distance);
  }
}
