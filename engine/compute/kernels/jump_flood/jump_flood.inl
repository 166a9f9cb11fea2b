// Jump flooding. A seed is packed as y * 65536 + x, so that its order is row-major and unpacking needs no division.

/// Seeds of a list of cells.
void seed_scatter(const SeedScatter::Params& params, const std::uint32_t* cells, std::uint8_t* seeds, Slice list) {
  for (std::uint32_t i = list.begin; i < list.end; ++i) {
    const std::uint32_t x = cells[i] & 0xFFFFU;
    const std::uint32_t y = cells[i] >> 16U;
    if (x < params.width && y < params.height) {
      // Two threads may set the same cell: an atomic store, which is an ordinary one in machine code.
      __atomic_store_n(seeds + at(params.stride, y) + x, std::uint8_t{1}, __ATOMIC_RELAXED);
    }
  }
}

inline std::uint32_t sq_distance_to(std::uint32_t seed, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t dx = (seed & 0xFFFFU) - x;
  const std::uint32_t dy = (seed >> 16U) - y;
  const std::uint32_t sq = dx * dx + dy * dy;  // modulo 2^32 the sign of the differences does not matter
  return seed == kNoSeed ? kNoSeed : sq;
}

void jump_flood_init(const JumpFloodInit::Params& params, const std::uint8_t* seeds, std::uint32_t* nearest,
                     CellRange range) {
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint8_t* __restrict in = seeds + at(params.stride, y);
    std::uint32_t* __restrict out = nearest + at(params.stride, y);
    const std::uint32_t row = y << 16U;
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = in[x] != 0 ? (row | x) : kNoSeed;
    }
  }
}

/// Cells of a row processed together.
constexpr std::uint32_t kFloodTile = 256;

/// Best seeds so far of the cells from (x, y) on.
struct FloodTile {
  std::uint32_t x;
  std::uint32_t y;
  std::uint32_t count;
  alignas(64) std::uint32_t sq_distance[kFloodTile];
  alignas(64) std::uint32_t seed[kFloodTile];
};

/// Offers each cell of the tile from `first` to `last` - 1 its seed in `source`, by (squared distance, index).
inline void offer(const std::uint32_t* __restrict source, std::uint32_t first, std::uint32_t last,
                  FloodTile& __restrict tile) {
  const std::uint32_t tile_x = tile.x;
  const std::uint32_t y = tile.y;
  for (std::uint32_t i = first; i < last; ++i) {
    const std::uint32_t seed = source[i];
    const std::uint32_t sq = sq_distance_to(seed, tile_x + i, y);
    const std::uint32_t best = tile.sq_distance[i];
    const std::uint32_t among_equals = lesser(seed, tile.seed[i]);
    const std::uint32_t kept = sq == best ? among_equals : tile.seed[i];
    tile.seed[i] = sq < best ? seed : kept;
    tile.sq_distance[i] = lesser(sq, best);
  }
}

/// Offers the tile the seeds of a source row at -step, 0 and +step columns.
inline void offer_row(const JumpFloodStep::Params& params, const std::uint32_t* row, FloodTile& tile) {
  const std::uint32_t step = params.step;
  const std::uint32_t* source = row + tile.x;
  const std::uint32_t first = step > tile.x ? lesser(step - tile.x, tile.count) : 0;
  if (first < tile.count) {
    offer(source - step, first, tile.count, tile);
  }
  offer(source, 0, tile.count, tile);
  const std::uint32_t beyond = tile.x + step < params.width ? params.width - step - tile.x : 0;
  if (beyond > 0) {
    offer(source + step, 0, lesser(beyond, tile.count), tile);
  }
}

void jump_flood_step(const JumpFloodStep::Params& params, const std::uint32_t* source, std::uint32_t* target,
                     CellRange range) {
  FloodTile tile;
  for (tile.y = range.y_begin; tile.y < range.y_end; ++tile.y) {
    for (tile.x = range.x_begin; tile.x < range.x_end; tile.x += kFloodTile) {
      tile.count = lesser(kFloodTile, range.x_end - tile.x);
      for (std::uint32_t i = 0; i < tile.count; ++i) {
        tile.sq_distance[i] = kNoSeed;
        tile.seed[i] = kNoSeed;
      }
      if (tile.y >= params.step) {
        offer_row(params, source + at(params.stride, tile.y - params.step), tile);
      }
      offer_row(params, source + at(params.stride, tile.y), tile);
      if (params.step < params.height - tile.y) {
        offer_row(params, source + at(params.stride, tile.y + params.step), tile);
      }
      __builtin_memcpy(target + at(params.stride, tile.y) + tile.x, tile.seed, tile.count * sizeof(std::uint32_t));
    }
  }
}

void jump_flood_distance(const JumpFloodDistance::Params& params, const std::uint32_t* nearest,
                         std::uint16_t* sq_distance, CellRange range) {
  const std::uint32_t most = params.radius * params.radius;
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint32_t* __restrict in = nearest + at(params.stride, y);
    std::uint16_t* __restrict out = sq_distance + at(params.stride, y);
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = static_cast<std::uint16_t>(lesser(sq_distance_to(in[x], x, y), most));
    }
  }
}
