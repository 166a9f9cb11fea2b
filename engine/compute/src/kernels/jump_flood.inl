// Jump flooding. A seed is packed as y * 65536 + x, so that its order is row-major and unpacking needs no division.

std::uint32_t sq_distance_to(std::uint32_t seed, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t dx = (seed & 0xFFFFU) - x;
  const std::uint32_t dy = (seed >> 16U) - y;
  return dx * dx + dy * dy;  // modulo 2^32 the sign of the differences does not matter
}

void jump_flood_init(const JumpFloodInit::Params& params, const std::uint8_t* seeds, std::uint32_t* nearest,
                     const CellRange& range) {
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint8_t* in = seeds + at(params.stride, y);
    std::uint32_t* out = nearest + at(params.stride, y);
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = in[x] != 0 ? (y << 16U | x) : kNoSeed;
    }
  }
}

/// A cell's best seed so far.
struct FloodBest {
  std::uint32_t sq_distance;
  std::uint32_t seed;
};

void consider(FloodBest& best, std::uint32_t seed, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t sq = seed == kNoSeed ? kNoSeed : sq_distance_to(seed, x, y);
  const bool better = sq < best.sq_distance || (sq == best.sq_distance && seed < best.seed);
  best.sq_distance = better ? sq : best.sq_distance;
  best.seed = better ? seed : best.seed;
}

void jump_flood_step(const JumpFloodStep::Params& params, const std::uint32_t* source, std::uint32_t* target,
                     const CellRange& range) {
  const std::int64_t step = params.step;
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      FloodBest best{kNoSeed, kNoSeed};
      for (std::int64_t ny = y - step; ny <= y + step; ny += step) {
        for (std::int64_t nx = x - step; nx <= x + step; nx += step) {
          if (ny >= 0 && ny < params.height && nx >= 0 && nx < params.width) {
            consider(best, source[ny * params.stride + nx], x, y);
          }
        }
      }
      target[at(params.stride, y) + x] = best.seed;
    }
  }
}

void jump_flood_distance(const JumpFloodDistance::Params& params, const std::uint32_t* nearest,
                         std::uint32_t* sq_distance, const CellRange& range) {
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint32_t* in = nearest + at(params.stride, y);
    std::uint32_t* out = sq_distance + at(params.stride, y);
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = in[x] == kNoSeed ? kNoSeed : sq_distance_to(in[x], x, y);
    }
  }
}
