// Unlimited distance transform, columns. An invocation sweeps four columns down and up the whole grid.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Seeds { uint seeds[]; };
layout(set = 0, binding = 1, std430) buffer Distance { uvec4 column_distance[]; };

// One cell further from the seed; none stays none.
uvec4 stepped(uvec4 distance) { return max(distance, distance + 1); }

void main() {
  uint quad = gl_GlobalInvocationID.x;
  if (quad >= (width + 3) / 4) {
    return;
  }
  uint row = stride / 4;
  uvec4 distance = uvec4(kNoSeed);
  uint end = height * row + quad;
  for (uint at = quad; at < end; at += row) {
    bvec4 is_seed = notEqual(unpack_bytes(seeds[at]), uvec4(0));
    distance = mix(stepped(distance), uvec4(0), is_seed);
    column_distance[at] = distance;
  }
  for (uint at = end - row; at >= row; at -= row) {
    uint above = at - row;
    distance = min(column_distance[above], stepped(distance));
    column_distance[above] = distance;
  }
}
