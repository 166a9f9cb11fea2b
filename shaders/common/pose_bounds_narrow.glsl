// pose_bounds with an invocation a row of a tile of 16 x 4, or a tile of 2 x 2, which walks through all points: for CPUs as
// devices. The includer defines POINTS_IN_UNIFORM where they come in a uniform buffer of at most 16 KiB.

#ifdef POINTS_IN_UNIFORM
layout(set = 0, binding = 1, std140) uniform Points { uvec4 points[1024]; };  // four points in three
#define POINT_WORDS(i) points[i]
#define POINT_WORD(i) points[(i) >> 2][(i) & 3u]
#else
layout(set = 0, binding = 1, std430) readonly buffer Points { uint points[]; };  // three each
#define POINT_WORDS(i) uvec4(points[4u * (i)], points[4u * (i) + 1u], points[4u * (i) + 2u], points[4u * (i) + 3u])
#define POINT_WORD(i) points[i]
#endif

#include "common/launch.glsl"
#include "common/pose_bounds.glsl"

// What a row of a tile has under the points of a block: 16 bytes, or two of each of the two rows of a small tile.
struct PairSums {
  uvec2 a;
  uvec2 b;
  uvec2 c;
  uvec2 d;
};

void add_point(inout PairSums sums, Looking looking, uint row, uint x, uint y, uint dilation) {
  uint byte = first_byte(looking, uintBitsToFloat(uvec2(x, y)), dilation);
  if (kIsWide == 1u) {
    byte += row * width;
    uint word = byte >> 2;
    uint shift = (byte & 3u) << 3;
    uint w0 = FIELD_WORD(word);
    uint w1 = FIELD_WORD(word + 1u);
    uint w2 = FIELD_WORD(word + 2u);
    uint w3 = FIELD_WORD(word + 3u);
    uint w4 = FIELD_WORD((byte + 15u) >> 2);
    sums.a += pairs_of(funnelled(w0, w1, shift));
    sums.b += pairs_of(funnelled(w1, w2, shift));
    sums.c += pairs_of(funnelled(w2, w3, shift));
    sums.d += pairs_of(funnelled(w3, w4, shift));
  } else {
    sums.a += pairs_of(four_bytes(byte, 2u));
    sums.b += pairs_of(four_bytes(byte + width, 2u));
  }
}

void add_four(inout PairSums sums, Looking looking, uint row, uint index) {
  uvec4 p = POINT_WORDS(index);
  uvec4 q = POINT_WORDS(index + 1u);
  uvec4 r = POINT_WORDS(index + 2u);
  add_point(sums, looking, row, p.x, p.y, p.z);
  add_point(sums, looking, row, p.w, q.x, q.y);
  add_point(sums, looking, row, q.z, q.w, r.x);
  add_point(sums, looking, row, r.y, r.z, r.w);
}

void main() {
  uint rows = kIsWide == 1u ? 4u : 1u;
  uint index = linear_invocation();
  if (index >= count * rows) {
    return;
  }
  Looking looking = looking_from(tiles[index / rows]);
  uint row = index % rows;
  uvec4 a = uvec4(0u);
  uvec4 b = uvec4(0u);
  uvec4 c = uvec4(0u);
  uvec4 d = uvec4(0u);
  for (uint first = 0u; first < point_count; first += kPairPoints) {
    uint end = min(first + kPairPoints, point_count);
    uint fours = (end - first) / 4u;
    PairSums block = PairSums(uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u));
    for (uint i = 0u; i < fours; ++i) {
      add_four(block, looking, row, 3u * (first / 4u + i));
    }
    for (uint i = first + 4u * fours; i < end; ++i) {
      add_point(block, looking, row, POINT_WORD(3u * i), POINT_WORD(3u * i + 1u), POINT_WORD(3u * i + 2u));
    }
    a += bytes_of(block.a);
    b += bytes_of(block.b);
    c += bytes_of(block.c);
    d += bytes_of(block.d);
  }
  if (kIsWide == 1u) {
    sums[4u * index] = a;
    sums[4u * index + 1u] = b;
    sums[4u * index + 2u] = c;
    sums[4u * index + 3u] = d;
  } else {
    sums[index] = uvec4(a.xy, b.xy);
  }
}
