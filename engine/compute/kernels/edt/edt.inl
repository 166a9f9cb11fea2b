// Truncated exact distance transform, two separable passes, and the seeds that it begins with. The passes' loops over a
// fixed number of cells are for the compiler to turn into vectors: 8- and 16-bit arithmetic throughout, no value of
// which leaves its range.

/// One row of the downward sweep, columns [begin, end).
inline void sweep_down(const std::uint8_t* __restrict seed, const std::uint8_t* __restrict above,
                       std::uint8_t* __restrict row, std::uint32_t begin, std::uint32_t end, std::uint8_t radius) {
  const std::uint8_t before_last = u8(radius - 1U);
  for (std::uint32_t x = begin; x < end; ++x) {
    const std::uint8_t next = u8(lesser(above[x], before_last) + 1U);
    row[x] = seed[x] != 0 ? std::uint8_t{0} : next;
  }
}

/// One row of the upward sweep.
inline void sweep_up(const std::uint8_t* __restrict below, std::uint8_t* __restrict row, std::uint32_t begin,
                     std::uint32_t end, std::uint8_t radius) {
  const std::uint8_t before_last = u8(radius - 1U);
  for (std::uint32_t x = begin; x < end; ++x) {
    row[x] = lesser(row[x], u8(lesser(below[x], before_last) + 1U));
  }
}

void edt_columns(const EdtColumns::Params& params, const std::uint8_t* seeds, std::uint8_t* distance, Slice columns) {
  if (params.height == 0) {
    return;
  }
  const std::uint8_t radius = u8(params.radius);
  for (std::uint32_t x = columns.begin; x < columns.end; ++x) {
    distance[x] = seeds[x] != 0 ? std::uint8_t{0} : radius;
  }
  for (std::uint32_t y = 1; y < params.height; ++y) {
    std::uint8_t* row = distance + at(params.stride, y);
    sweep_down(seeds + at(params.stride, y), row - params.stride, row, columns.begin, columns.end, radius);
  }
  for (std::uint32_t y = params.height - 1; y-- > 0;) {
    std::uint8_t* row = distance + at(params.stride, y);
    sweep_up(row + params.stride, row, columns.begin, columns.end, radius);
  }
}

/// best = min(best, cells dx to kEdtOffsets - 1 further to both sides plus their squared offsets). Sums stop at R*R,
/// which no best exceeds, so that they stay within 16 bits.
inline void search_offsets(const std::uint16_t* squares, std::uint16_t* __restrict best, std::uint32_t dx,
                           std::uint32_t sq_radius) {
  for (std::uint32_t step = 0; step < kEdtOffsets; ++step, ++dx) {
    const std::uint16_t sq = u16(lesser(dx * dx, sq_radius));
    const std::uint16_t most = u16(sq_radius - sq);
    const std::uint16_t* left = squares - dx;
    const std::uint16_t* right = squares + dx;
    for (std::uint32_t i = 0; i < kEdtTile; ++i) {
      best[i] = lesser(best[i], u16(lesser(lesser(left[i], right[i]), most) + sq));
    }
  }
}

inline std::uint16_t smallest(const std::uint16_t* values) {
  std::uint16_t least = values[0];
  for (std::uint32_t i = 0; i < kEdtTile; ++i) {
    least = lesser(least, values[i]);
  }
  return least;
}

inline std::uint16_t largest(const std::uint16_t* values) {
  std::uint16_t most = values[0];
  for (std::uint32_t i = 0; i < kEdtTile; ++i) {
    most = greater(most, values[i]);
  }
  return most;
}

/// A row between its margins.
struct EdtRow {
  std::uint16_t* squares;  ///< of the column distances; R*R in the margins and behind the last cell
  std::uint16_t* least;    ///< smallest square of each tile
  std::uint32_t tiles;
};

/// Smallest square that the tile can see.
inline std::uint32_t least_in_reach(const EdtRow& row, std::uint32_t tile, std::uint32_t reach_tiles) {
  const std::uint32_t first = tile > reach_tiles ? tile - reach_tiles : 0;
  const std::uint32_t last = lesser(tile + reach_tiles, row.tiles - 1);
  std::uint16_t least = row.least[first];
  for (std::uint32_t i = first + 1; i <= last; ++i) {
    least = lesser(least, row.least[i]);
  }
  return least;
}

/// Minimum over all offsets below R for one tile; offsets grow until none can improve any of its cells.
inline void search_tile(const EdtRow& row, std::uint32_t tile, std::uint32_t radius, std::uint16_t* best) {
  const std::uint16_t* squares = row.squares + tile * kEdtTile;
  for (std::uint32_t i = 0; i < kEdtTile; ++i) {
    best[i] = squares[i];
  }
  const std::uint32_t least = least_in_reach(row, tile, (radius + kEdtTile - 1) / kEdtTile);
  for (std::uint32_t dx = 1; dx < radius; dx += kEdtOffsets) {
    if (dx * dx + least >= largest(best)) {
      return;
    }
    search_offsets(squares, best, dx, radius * radius);
  }
}

inline void square_cells(const std::uint8_t* __restrict distance, std::uint16_t* __restrict squares,
                         std::uint32_t width) {
  for (std::uint32_t x = 0; x < width; ++x) {
    squares[x] = u16(static_cast<std::uint32_t>(distance[x]) * distance[x]);
  }
}

inline void copy_cells(const std::uint16_t* __restrict from, std::uint16_t* __restrict to, std::uint32_t count) {
  __builtin_memcpy(to, from, count * sizeof(std::uint16_t));
}

void edt_rows(const EdtRows::Params& params, const std::uint8_t* distance, std::uint16_t* sq_distance, Slice rows,
              std::uint16_t* scratch) {
  const std::uint32_t margin = edt_rows_margin(params);
  const std::uint16_t sq_radius = u16(params.radius * params.radius);
  EdtRow row{scratch + margin, nullptr, static_cast<std::uint32_t>(edt_tiled_width(params.width) / kEdtTile)};
  row.least = row.squares + row.tiles * kEdtTile + margin;
  for (std::uint32_t i = 0; i < margin; ++i) {
    scratch[i] = sq_radius;
    row.squares[row.tiles * kEdtTile + i] = sq_radius;
  }
  for (std::uint32_t x = params.width; x < row.tiles * kEdtTile; ++x) {
    row.squares[x] = sq_radius;
  }
  for (std::uint32_t y = rows.begin; y < rows.end; ++y) {
    square_cells(distance + at(params.stride, y), row.squares, params.width);
    for (std::uint32_t tile = 0; tile < row.tiles; ++tile) {
      row.least[tile] = smallest(row.squares + tile * kEdtTile);
    }
    for (std::uint32_t tile = 0; tile < row.tiles; ++tile) {
      std::uint16_t best[kEdtTile];
      search_tile(row, tile, params.radius, best);
      const std::uint32_t first = tile * kEdtTile;
      copy_cells(best, sq_distance + at(params.stride, y) + first, lesser(kEdtTile, params.width - first));
    }
  }
}

/// Seeds of a list of cells.
void seed_scatter(const SeedScatter::Params& params, const std::uint32_t* cells, std::uint8_t* seeds, Slice list) {
  for (std::uint32_t i = list.begin; i < list.end; ++i) {
    const std::uint32_t x = cells[i] & 0xFFFFU;
    const std::uint32_t y = cells[i] >> 16U;
    if (x < params.width && y < params.height) {
      // Two threads may name the same cell: an atomic store, which is an ordinary one in the machine's code.
      __atomic_store_n(seeds + at(params.stride, y) + x, std::uint8_t{1}, __ATOMIC_RELAXED);
    }
  }
}
