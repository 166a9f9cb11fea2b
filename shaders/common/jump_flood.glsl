// Seeds of the jump flood: packed as y * 65536 + x, compared by (squared distance, seed).
#ifndef GDTSLAM_JUMP_FLOOD_GLSL
#define GDTSLAM_JUMP_FLOOD_GLSL

const uint kNoSeed = 0xFFFFFFFFu;

// Squared distance of a cell to a seed; kNoSeed for none. Modulo 2^32 the sign of the differences does not matter.
uint sq_distance_to(uint seed, uint x, uint y) {
  uint dx = (seed & 0xFFFFu) - x;
  uint dy = (seed >> 16) - y;
  return seed == kNoSeed ? kNoSeed : dx * dx + dy * dy;
}

// The best seed of a cell so far.
struct Flood {
  uint sq;
  uint seed;
};

void offer(inout Flood best, uint seed, uint x, uint y) {
  uint sq = sq_distance_to(seed, x, y);
  bool better = sq < best.sq || (sq == best.sq && seed < best.seed);
  best.seed = better ? seed : best.seed;
  best.sq = better ? sq : best.sq;
}

#endif
