// Unlimited distance transform, columns. A work group does the columns of a few words; its invocations along y do a
// strip of rows each. They look for the first and last seed of their strip, learn from each other through shared memory
// how far the next seed beyond the strip is, and then sweep it down and up.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"
#include "common/packed.glsl"

const uint kMostInvocations = 256;  // of a work group, the most that forms/edt_full_columns.cpp asks for
layout(set = 0, binding = 0, std430) readonly buffer Seeds { uint seeds[]; };
layout(set = 0, binding = 1, std430) buffer Distance { uvec4 column_distance[]; };
shared uvec4 first_seed[kMostInvocations];  // row of a strip's first seed, kNoSeed for none
shared uvec4 last_seed[kMostInvocations];

uvec4 stepped(uvec4 distance) { return max(distance, distance + 1); }

// Fills in the shared rows of the strip [begin, end).
void find_seeds(uint quad, uint begin, uint end) {
  uvec4 first = uvec4(kNoSeed);
  uvec4 last = uvec4(kNoSeed);
  for (uint y = begin; y < end; ++y) {
    bvec4 is_seed = notEqual(unpack_bytes(seeds[y * (stride / 4) + quad]), uvec4(0));
    last = mix(last, uvec4(y), is_seed);
    first = min(first, mix(uvec4(kNoSeed), uvec4(y), is_seed));
  }
  first_seed[gl_LocalInvocationIndex] = first;
  last_seed[gl_LocalInvocationIndex] = last;
}

// Distance from row `begin` - 1 to the next seed at or above it.
uvec4 distance_above(uint begin) {
  uvec4 row = uvec4(kNoSeed);
  for (uint strip = gl_LocalInvocationID.y; strip > 0 && any(equal(row, uvec4(kNoSeed))); --strip) {
    uvec4 last = last_seed[(strip - 1) * gl_WorkGroupSize.x + gl_LocalInvocationID.x];
    row = mix(row, last, equal(row, uvec4(kNoSeed)));
  }
  return mix(begin - 1 - row, uvec4(kNoSeed), equal(row, uvec4(kNoSeed)));
}

// Distance from row `end` to the next seed at or below it.
uvec4 distance_below(uint end) {
  uvec4 row = uvec4(kNoSeed);
  for (uint strip = gl_LocalInvocationID.y + 1;
       strip < gl_WorkGroupSize.y && any(equal(row, uvec4(kNoSeed))); ++strip) {
    row = min(row, first_seed[strip * gl_WorkGroupSize.x + gl_LocalInvocationID.x]);
  }
  return mix(row - end, uvec4(kNoSeed), equal(row, uvec4(kNoSeed)));
}

void sweep(uint quad, uint begin, uint end) {
  uint row = stride / 4;
  uvec4 distance = distance_above(begin);
  for (uint y = begin; y < end; ++y) {
    bvec4 is_seed = notEqual(unpack_bytes(seeds[y * row + quad]), uvec4(0));
    distance = mix(stepped(distance), uvec4(0), is_seed);
    column_distance[y * row + quad] = distance;
  }
  distance = distance_below(end);
  for (uint y = end; y > begin; --y) {
    uint at = (y - 1) * row + quad;
    distance = min(column_distance[at], stepped(distance));
    column_distance[at] = distance;
  }
}

void main() {
  uint quad = gl_GlobalInvocationID.x;
  bool is_in_grid = quad < (width + 3) / 4;
  uint strip_rows = (height + gl_WorkGroupSize.y - 1) / gl_WorkGroupSize.y;
  uint begin = min(gl_LocalInvocationID.y * strip_rows, height);
  uint end = min(begin + strip_rows, height);
  find_seeds(is_in_grid ? quad : 0, begin, end);
  barrier();
  if (is_in_grid) {
    sweep(quad, begin, end);
  }
}
