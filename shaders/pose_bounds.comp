// Bounds of tiles of boxes, a work group a tile: its invocations say where a block of points begins to read, one each, and
// then share the reading out, four bytes of a row and a part of the points each. The sums are of integers, so how they
// are shared out does not matter.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
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
  uint count;  // number of tiles, from the launch
};
struct Tile {
  float x;
  float y;
  float theta;
  uint unused;
};
layout(set = 0, binding = 0, std430) readonly buffer Field { uint field[]; };
layout(set = 0, binding = 2, std430) readonly buffer Tiles { Tile tiles[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Sums { uvec4 sums[]; };  // a tile of 2 x 2, a quarter of a row

#include "common/elementary.glsl"

// Values that do not change from point to point.
struct Looking {
  float s;
  float c;
  vec2 translation;
  float bias;
  int mask;
  ivec2 first;
  ivec2 last;  // limits for the position at which a tile begins to read
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
  return funnelled(field[byte >> 2], field[(byte + used - 1u) >> 2], (byte & 3u) << 3);
}

// Two bytes of a word each in 16 bits: the sums of so many points fit.
const uint kPairs = 0x00FF00FFu;

uvec2 pairs_of(uint four) { return uvec2(four, four >> 8) & kPairs; }  // bytes 0 and 2, bytes 1 and 3
uvec4 bytes_of(uvec2 pairs) { return uvec4(pairs & 0xFFFFu, pairs >> 16); }

const uint kMostInvocations = 128;
struct Point {
  float x;
  float y;
  uint dilation;
};
layout(set = 0, binding = 1, std430) readonly buffer Points { Point points[]; };
shared uint begin_of[kMostInvocations];
shared uvec4 sum_of[kMostInvocations];

void main() {
  uint own = gl_LocalInvocationID.x;
  uint tile = linear_group();
  bool is_in_launch = tile < count;  // the same for the whole group
  uint to_do = is_in_launch ? point_count : 0u;
  Looking looking = looking_from(tiles[is_in_launch ? tile : 0u]);
  // Each invocation reads one of the tile's words, four bytes each, under every so many points.
  uint row_words = kIsWide == 1u ? 4u : 1u;
  uint used = kIsWide == 1u ? 4u : 2u;
  uint words = row_words * (kIsWide == 1u ? 4u : 2u);
  uint word = own % words;
  uint share = own / words;
  uint shares = gl_WorkGroupSize.x / words;
  uint offset = (word / row_words) * width + (word % row_words) * 4u;
  uvec4 sum = uvec4(0u);
  for (uint first = 0u; first < to_do; first += gl_WorkGroupSize.x) {
    uint in_block = min(gl_WorkGroupSize.x, to_do - first);
    if (own < in_block) {
      Point point = points[first + own];
      begin_of[own] = first_byte(looking, vec2(point.x, point.y), point.dilation);
    }
    barrier();
    uvec2 pairs = uvec2(0u);
    for (uint i = share; i < in_block; i += shares) {
      pairs += pairs_of(four_bytes(begin_of[i] + offset, used));
    }
    sum += bytes_of(pairs);
    barrier();
  }
  sum_of[own] = sum;
  for (uint half_size = gl_WorkGroupSize.x / 2u; half_size >= words; half_size /= 2u) {
    barrier();
    if (own < half_size) {
      sum_of[own] += sum_of[own + half_size];
    }
  }
  barrier();
  if (kIsWide == 1u) {
    if (own < words && is_in_launch) {
      sums[words * tile + own] = sum_of[own];
    }
  } else if (own == 0u && is_in_launch) {
    sums[tile] = uvec4(sum_of[0].xy, sum_of[1].xy);
  }
}
