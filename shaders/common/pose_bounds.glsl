// What the shaders of pose_bounds share: its bindings but for the points, where a point of a tile begins to read
// (engine/compute/kernels/pose_bounds/pose_bounds.hpp) and how bytes come out of the field's words.
#ifndef GDTSLAM_POSE_BOUNDS_GLSL
#define GDTSLAM_POSE_BOUNDS_GLSL

layout(constant_id = 10) const uint kIsWide = 1;  // tiles of 16 x 4, else of 2 x 2
layout(push_constant) uniform Params {
  uint width;
  uint height;
  int first_column;
  int first_row;
  uint phase_bits;
  float samples_per_cell;
  uint point_count;
  uint last_field;
  uint tile_width;
  uint tile_height;
  uint count;  // of the tiles, from the launch
};
struct Tile {
  float x;
  float y;
  float theta;
  uint unused;
};
layout(set = 0, binding = 2, std430) readonly buffer Tiles { Tile tiles[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Sums { uvec4 sums[]; };  // a tile of 2 x 2, a quarter of a row

#include "common/elementary.glsl"
#include "common/field_words.glsl"

// What does not change from point to point.
struct Looking {
  float s;
  float c;
  vec2 translation;
  float bias;
  int mask;
  ivec2 first;
  ivec2 last;  // where a tile may begin to read
  int plane;   // samples of one
};

Looking looking_from(Tile tile) {
  SinCosF32 rotation = sin_cos_f32(tile.theta);
  precise float half_sample = 0.5 * samples_per_cell;
  precise float bias = (0.5 - half_sample) + float(1 << phase_bits);
  return Looking(rotation.sin_value, rotation.cos_value, vec2(tile.x, tile.y), bias, (1 << phase_bits) - 1,
                 ivec2(first_column, first_row) - 1, ivec2(width - tile_width, height - tile_height),
                 int(width * height));
}

/// The sample nearest to a position in cells, a spacing on; NaN counts as far off.
int nearest_sample(Looking looking, float cells) {
  precise float place = cells * samples_per_cell + looking.bias;
  place = floor(place);
  place = place > -1073741824.0 ? place : -1073741824.0;
  place = place < 1073741824.0 ? place : 1073741824.0;
  return int(place);
}

/// The byte of the field at which a point's tile begins.
uint first_byte(Looking looking, vec2 point, uint dilation) {
  precise float x = (looking.c * point.x - looking.s * point.y) + looking.translation.x;
  precise float y = (looking.s * point.x + looking.c * point.y) + looking.translation.y;
  ivec2 at = ivec2(nearest_sample(looking, x), nearest_sample(looking, y));
  ivec2 cell = clamp((at >> phase_bits) + looking.first, ivec2(0), looking.last);
  ivec2 phase = at & looking.mask;
  int inside = ((phase.y << phase_bits) + phase.x) * looking.plane + cell.y * int(width) + cell.x;
  return min(dilation, last_field) + uint(inside);
}

/// Four bytes of two words, from bit `shift` of the lower one on; a shift by 32 bits is undefined.
uint funnelled(uint low, uint high, uint shift) { return (low >> shift) | ((high << (31u - shift)) << 1); }

/// Four bytes that begin at `byte`, of which the first `used` matter: no word is read that holds none of them.
uint four_bytes(uint byte, uint used) {
  return funnelled(FIELD_WORD(byte >> 2), FIELD_WORD((byte + used - 1u) >> 2), (byte & 3u) << 3);
}

// Two bytes of a word each in 16 bits: the sums of so many points fit.
const uint kPairs = 0x00FF00FFu;
const uint kPairPoints = 256u;

uvec2 pairs_of(uint four) { return uvec2(four, four >> 8) & kPairs; }  // bytes 0 and 2, bytes 1 and 3
uvec4 bytes_of(uvec2 pairs) { return uvec4(pairs & 0xFFFFu, pairs >> 16); }

#endif
