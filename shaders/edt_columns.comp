// Truncated distance transform, columns. An invocation does four columns, one word, of a strip of rows: it sweeps up to
// the strip's first row from as far below it as a seed can matter, and down from as far above.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(constant_id = 10) const uint kStripRows = 16;
layout(set = 0, binding = 0, std430) readonly buffer Seeds { uint seeds[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Distance { uint column_distance[]; };

uvec4 stepped(uvec4 distance, uint seed_word) {
  bvec4 is_seed = notEqual(unpack_bytes(seed_word), uvec4(0));
  return mix(min(distance + 1, uvec4(radius)), uvec4(0), is_seed);
}

void sweep_strip(uint word, uint begin, uint end) {
  uint row = stride / 4;
  uint below[kStripRows];
  uvec4 distance = uvec4(radius);
  for (uint y = min(end + radius - 1, height); y > end; --y) {
    distance = stepped(distance, seeds[(y - 1) * row + word]);
  }
  for (uint y = end; y > begin; --y) {
    distance = stepped(distance, seeds[(y - 1) * row + word]);
    below[y - 1 - begin] = pack_bytes(distance);
  }
  distance = uvec4(radius);
  for (uint y = begin - min(begin, radius - 1); y < begin; ++y) {
    distance = stepped(distance, seeds[y * row + word]);
  }
  for (uint y = begin; y < end; ++y) {
    distance = stepped(distance, seeds[y * row + word]);
    column_distance[y * row + word] = pack_bytes(min(distance, unpack_bytes(below[y - begin])));
  }
}

void main() {
  uint word = gl_GlobalInvocationID.x;
  if (word >= (width + 3) / 4) {
    return;
  }
  for (uint begin = gl_GlobalInvocationID.y * kStripRows; begin < height; begin += launch_rows() * kStripRows) {
    sweep_strip(word, begin, min(begin + kStripRows, height));
  }
}
