// Bounds of tiles of boxes, an invocation a tile, which goes through all points: for CPUs as devices. The points are in a
// uniform buffer and the field in texels, from which both come faster there.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
layout(set = 0, binding = 1, std140) uniform Points { uvec4 points[1024]; };  // four points in three

uint point_word(uint i) { return points[i >> 2][i & 3u]; }

#include "common/launch.glsl"
#include "common/pose_bounds.glsl"

// What a row of a tile has under the points of a block: four bytes of it in turn.
struct RowSums {
  uvec2 a;
  uvec2 b;
  uvec2 c;
  uvec2 d;
};
#define NO_SUMS RowSums(uvec2(0u), uvec2(0u), uvec2(0u), uvec2(0u))

void add_row(inout RowSums sums, uint byte) {
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
}

// A small tile has its rows in the first two members of the first.
void add_point(inout RowSums rows[4], Looking looking, uint x, uint y, uint dilation) {
  uint byte = first_byte(looking, uintBitsToFloat(uvec2(x, y)), dilation);
  if (kIsWide == 1u) {
    add_row(rows[0], byte);
    add_row(rows[1], byte + width);
    add_row(rows[2], byte + 2u * width);
    add_row(rows[3], byte + 3u * width);
  } else {
    rows[0].a += pairs_of(four_bytes(byte, 2u));
    rows[0].b += pairs_of(four_bytes(byte + width, 2u));
  }
}

void add_four(inout RowSums rows[4], Looking looking, uint index) {
  uvec4 p = points[index];
  uvec4 q = points[index + 1u];
  uvec4 r = points[index + 2u];
  add_point(rows, looking, p.x, p.y, p.z);
  add_point(rows, looking, p.w, q.x, q.y);
  add_point(rows, looking, q.z, q.w, r.x);
  add_point(rows, looking, r.y, r.z, r.w);
}

// The sums of points [first, end), a block.
void sum_block(inout RowSums rows[4], Looking looking, uint first, uint end) {
  uint fours = (end - first) / 4u;
  for (uint i = 0u; i < fours; ++i) {
    add_four(rows, looking, 3u * (first / 4u + i));
  }
  for (uint i = first + 4u * fours; i < end; ++i) {
    add_point(rows, looking, point_word(3u * i), point_word(3u * i + 1u), point_word(3u * i + 2u));
  }
}

const uvec4 kNone = uvec4(0u);
#define FOR_EACH_ROW(STEP) STEP(0u) STEP(1u) STEP(2u) STEP(3u)

void main() {
  uint index = linear_invocation();
  if (index >= count) {
    return;
  }
  Looking looking = looking_from(tiles[index]);
  uvec4 total[16] = uvec4[](kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone,  //
                            kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone);
  for (uint first = 0u; first < point_count; first += kPairPoints) {
    RowSums rows[4] = RowSums[](NO_SUMS, NO_SUMS, NO_SUMS, NO_SUMS);
    sum_block(rows, looking, first, min(first + kPairPoints, point_count));
#define ADD_ROW(i)                             \
  total[4u * i] += bytes_of(rows[i].a);        \
  total[4u * i + 1u] += bytes_of(rows[i].b);   \
  total[4u * i + 2u] += bytes_of(rows[i].c);   \
  total[4u * i + 3u] += bytes_of(rows[i].d);
    FOR_EACH_ROW(ADD_ROW)
  }
  if (kIsWide == 1u) {
    uint to = 16u * index;
#define STORE_ROW(i)                           \
  sums[to + 4u * i] = total[4u * i];           \
  sums[to + 4u * i + 1u] = total[4u * i + 1u]; \
  sums[to + 4u * i + 2u] = total[4u * i + 2u]; \
  sums[to + 4u * i + 3u] = total[4u * i + 3u];
    FOR_EACH_ROW(STORE_ROW)
  } else {
    sums[index] = uvec4(total[0].xy, total[1].xy);
  }
}
