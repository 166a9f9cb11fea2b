// Jump flooding, one pass, for jumps of 1, 2 or a multiple of 4 cells. An invocation does four cells of every row that
// is a whole number of jumps beyond its first one, so that what it reads serves three rows.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/jump_flood.glsl"
#include "common/launch.glsl"

layout(constant_id = 10) const uint kShift = 0;  // the jump modulo 4
layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint jump;
};
layout(set = 0, binding = 0, std430) readonly buffer Source { uvec4 source[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Target { uvec4 target[]; };

// The seeds that four cells of a row find in another row, a jump to the left, none and a jump to the right.
struct Seeds {
  uvec4 left;
  uvec4 middle;
  uvec4 right;
};

struct Floods {
  uvec4 sq;
  uvec4 seed;
};

uvec4 turned_left(uvec4 before, uvec4 own) {
  return kShift == 1 ? uvec4(before.w, own.xyz) : uvec4(before.zw, own.xy);
}

uvec4 turned_right(uvec4 own, uvec4 behind) {
  return kShift == 1 ? uvec4(own.yzw, behind.x) : uvec4(own.zw, behind.xy);
}

bvec4 both(bvec4 a, bool b) { return bvec4(uvec4(a) * uint(b)); }

// Seeds of row y for the cells from 4 * quad on; none beyond the grid.
Seeds seeds_of(uint quad, uint y) {
  uint last = (width - 1) / 4;
  uint away = kShift == 0 ? jump / 4 : 1;
  uint row = min(y, height - 1) * (stride / 4);
  uvec4 before = source[row + quad - min(away, quad)];
  uvec4 own = source[row + quad];
  uvec4 behind = source[row + quad + min(away, last - quad)];
  Seeds seeds = Seeds(before, own, behind);
  if (kShift != 0) {
    seeds = Seeds(turned_left(before, own), own, turned_right(own, behind));
  }
  uvec4 x = quad * 4 + uvec4(0, 1, 2, 3);
  bool is_in_grid = y < height;
  bvec4 has_left = greaterThanEqual(x, uvec4(jump));
  bvec4 has_right = lessThan(uvec4(jump), uvec4(width) - min(x, uvec4(width)));
  seeds.left = mix(uvec4(kNoSeed), seeds.left, both(has_left, is_in_grid));
  seeds.middle = mix(uvec4(kNoSeed), seeds.middle, bvec4(is_in_grid));
  seeds.right = mix(uvec4(kNoSeed), seeds.right, both(has_right, is_in_grid));
  return seeds;
}

void offer_each(inout Floods best, uvec4 seed, uvec4 x, uint y) {
  uvec4 dx = (seed & 0xFFFFu) - x;
  uvec4 dy = (seed >> 16) - y;
  uvec4 sq = mix(dx * dx + dy * dy, uvec4(kNoSeed), equal(seed, uvec4(kNoSeed)));
  // Of equal distances the lower index.
  uvec4 among_equals = mix(best.seed, min(seed, best.seed), equal(sq, best.sq));
  best.seed = mix(among_equals, seed, lessThan(sq, best.sq));
  best.sq = min(sq, best.sq);
}

void offer_row(inout Floods best, Seeds seeds, uvec4 x, uint y) {
  offer_each(best, seeds.left, x, y);
  offer_each(best, seeds.middle, x, y);
  offer_each(best, seeds.right, x, y);
}

void main() {
  uint quad = gl_GlobalInvocationID.x;
  uint first = gl_GlobalInvocationID.y;
  if (quad > (width - 1) / 4 || first >= height) {
    return;
  }
  uvec4 x = quad * 4 + uvec4(0, 1, 2, 3);
  Seeds none = Seeds(uvec4(kNoSeed), uvec4(kNoSeed), uvec4(kNoSeed));
  Seeds above = none;
  Seeds own = seeds_of(quad, first);
  for (uint y = first; y < height; y += jump) {
    Seeds below = seeds_of(quad, y + jump);
    Floods best = Floods(uvec4(kNoSeed), uvec4(kNoSeed));
    offer_row(best, above, x, y);
    offer_row(best, own, x, y);
    offer_row(best, below, x, y);
    target[y * (stride / 4) + quad] = best.seed;
    above = own;
    own = below;
  }
}
