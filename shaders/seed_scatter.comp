#version 450
#extension GL_GOOGLE_include_directive : require
// Seeds of a list of cells (engine/compute/kernels/jump_flood/jump_flood.hpp, SeedScatter).

layout(set = 0, binding = 0, std430) readonly buffer Cells { uint cells[]; };
layout(set = 0, binding = 1, std430) buffer Seeds { uint seeds[]; };  // four a word

layout(push_constant) uniform Params {
  uint count;
  uint width;
  uint height;
  uint stride;
} params;

#include "common/launch.glsl"

void main() {
  uint i = linear_invocation();
  if (i >= params.count) {
    return;
  }
  uint x = cells[i] & 0xFFFFu;
  uint y = cells[i] >> 16;
  if (x < params.width && y < params.height) {
    uint word = (y * params.stride + x) >> 2;
    uint shift = (x & 3u) << 3;
    // The byte becomes 1 whatever it was. Others that set it too may come in between: each clears before it sets, so
    // the last of these operations on the byte sets it; other bytes of the word are not touched.
    atomicAnd(seeds[word], ~(0xFFu << shift));
    atomicOr(seeds[word], 1u << shift);
  }
}
