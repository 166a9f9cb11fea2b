// Unlimited distance transform, rows. A work group does a piece of a row, an invocation some of its cells, one by one:
// it searches outwards up to kReach, then by blocks of kBlock cells, of which it looks into those only whose smallest
// column distance (in shared memory) can still improve the cell. So what is far costs a look at blocks, not at cells.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"

layout(constant_id = 10) const uint kCellsEach = 4;
const uint kBlock = 32;
const uint kReach = 16;
const uint kMostBlocks = 1024;   // of a row of 32767 cells
const uint kFarthest = 0x7FFFu;  // more than any distance; its square leaves room for another's in 32 bits
layout(set = 0, binding = 0, std430) readonly buffer Distance { uvec4 column_distance[]; };
layout(set = 0, binding = 1, std430) writeonly buffer SqDistance { uint sq_distance[]; };
shared uint least_of_block[kMostBlocks];

uint blocks() { return (width + kBlock - 1) / kBlock; }

// The cells of a quad of the row that begins at quad `row`; kFarthest for those without a seed or outside of the row.
uvec4 quad_at(uint row, uint quad) {
  uvec4 distance = column_distance[row + min(quad, (width - 1) / 4)];
  uvec4 x = quad * 4 + uvec4(0, 1, 2, 3);
  return mix(uvec4(kFarthest), min(distance, uvec4(kFarthest)), lessThan(x, uvec4(width)));
}

void find_least(uint row) {
  for (uint block = gl_LocalInvocationID.x; block < blocks(); block += gl_WorkGroupSize.x) {
    least_of_block[block] = kFarthest;
  }
  barrier();
  for (uint quad = gl_LocalInvocationID.x; quad < (width + 3) / 4; quad += gl_WorkGroupSize.x) {
    uvec4 distance = quad_at(row, quad);
    atomicMin(least_of_block[quad * 4 / kBlock], min(min(distance.x, distance.y), min(distance.z, distance.w)));
  }
  barrier();
}

// The column's seed `offset` cells away as a candidate. What lies outside of the row or has no seed is no improvement.
uint improved(uint best, uint row, uint x, uint offset) {
  uint distance = x < width ? column_distance[row + x / 4][x % 4] : kNoSeed;
  return distance == kNoSeed ? best : min(best, distance * distance + offset * offset);
}

// Whether a block whose nearest cell is `offset` cells away can hold something better.
bool may_improve(uint best, uint block, uint offset) {
  uint least = least_of_block[block];
  return least != kFarthest && least * least + offset * offset < best;
}

uint search_block(uint best, uint row, uint x, uint block) {
  for (uint i = 0; i < kBlock / 4; ++i) {
    uint quad = block * (kBlock / 4) + i;
    uvec4 distance = quad_at(row, quad);
    uvec4 offsets = quad * 4 + uvec4(0, 1, 2, 3) - x;  // modulo 2^32 the sign does not matter
    uvec4 sq = distance * distance + offsets * offsets;
    sq = mix(sq, uvec4(kNoSeed), equal(distance, uvec4(kFarthest)));
    best = min(best, min(min(sq.x, sq.y), min(sq.z, sq.w)));
  }
  return best;
}

bool left_may_improve(uint best, uint x, uint away) {
  uint own = x / kBlock;
  uint offset = x - (own - away + 1) * kBlock + 1;  // to the last cell of the block on the left
  return away <= own && may_improve(best, own - min(away, own), offset);
}

bool right_may_improve(uint best, uint x, uint away) {
  uint block = x / kBlock + away;
  return block < blocks() && may_improve(best, min(block, kMostBlocks - 1), block * kBlock - x);
}

// The first distance in blocks, from `away` on, at which a block can hold something better; none: the number of blocks.
uint next_away(uint best, uint x, uint away) {
  while (away < blocks() && !left_may_improve(best, x, away) && !right_may_improve(best, x, away)) {
    uint beyond = away * kBlock + 1;  // at least so far are the blocks after these two
    away = beyond * beyond < best ? away + 1 : blocks();
  }
  return away;
}

uint search_blocks(uint best, uint row, uint x) {
  uint own = x / kBlock;
  best = search_block(best, row, x, own);
  for (uint away = next_away(best, x, 1); away < blocks(); away = next_away(best, x, away + 1)) {
    if (left_may_improve(best, x, away)) {
      best = search_block(best, row, x, own - away);
    }
    if (right_may_improve(best, x, away)) {
      best = search_block(best, row, x, own + away);
    }
  }
  return best;
}

uint search(uint row, uint x) {
  uint best = improved(kNoSeed, row, x, 0);
  uint offset = 1;
  for (; offset < kReach && offset * offset < best; ++offset) {
    best = improved(best, row, x - offset, offset);  // left of column 0 is beyond the width, modulo 2^32
    best = improved(best, row, x + offset, offset);
  }
  return offset * offset < best ? search_blocks(best, row, x) : best;
}

void main() {
  uint piece = gl_WorkGroupSize.x * kCellsEach;
  uint pieces = (width + piece - 1) / piece;
  uint y = linear_group() / pieces;
  if (y >= height) {
    return;
  }
  find_least(y * (stride / 4));
  uint first = linear_group() % pieces * piece + gl_LocalInvocationID.x;
  for (uint i = 0; i < kCellsEach; ++i) {
    uint x = first + i * gl_WorkGroupSize.x;
    if (x < width) {
      sq_distance[y * stride + x] = search(y * (stride / 4), x);
    }
  }
}
