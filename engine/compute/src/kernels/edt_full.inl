// Unlimited exact distance transform: columns by two sweeps; rows by a search to both sides in vectors, which ends soon
// where seeds are near, else by the lower envelope of parabolas [Meijster2000], whose time does not depend on the
// distances.

/// One row of the downward sweep, columns [begin, end).
inline void sweep_down(const std::uint8_t* __restrict seed, const std::uint32_t* __restrict above,
                       std::uint32_t* __restrict row, std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t x = begin; x < end; ++x) {
    const std::uint32_t next = above[x] == kNoSeed ? kNoSeed : above[x] + 1;
    row[x] = seed[x] != 0 ? 0 : next;
  }
}

/// One row of the upward sweep.
inline void sweep_up(const std::uint32_t* __restrict below, std::uint32_t* __restrict row, std::uint32_t begin,
                     std::uint32_t end) {
  for (std::uint32_t x = begin; x < end; ++x) {
    const std::uint32_t next = below[x] == kNoSeed ? kNoSeed : below[x] + 1;
    row[x] = lesser(row[x], next);
  }
}

void edt_full_columns(const EdtFullColumns::Params& params, const std::uint8_t* seeds, std::uint32_t* distance,
                      std::uint32_t begin, std::uint32_t end) {
  if (params.height == 0) {
    return;
  }
  for (std::uint32_t x = begin; x < end; ++x) {
    distance[x] = seeds[x] != 0 ? 0 : kNoSeed;
  }
  for (std::uint32_t y = 1; y < params.height; ++y) {
    std::uint32_t* row = distance + at(params.stride, y);
    sweep_down(seeds + at(params.stride, y), row - params.stride, row, begin, end);
  }
  for (std::uint32_t y = params.height - 1; y-- > 0;) {
    std::uint32_t* row = distance + at(params.stride, y);
    sweep_up(row + params.stride, row, begin, end);
  }
}

/// First column at which the parabola of `right` is strictly below that of `left` < `right`.
std::int64_t envelope_crossing(std::int64_t left, std::int64_t sq_left, std::int64_t right, std::int64_t sq_right) {
  const std::int64_t twice = right * right + sq_right - left * left - sq_left;
  const std::int64_t span = 2 * (right - left);
  const std::int64_t quotient = twice / span;
  return quotient - (twice % span < 0 ? 1 : 0) + 1;
}

/// Lower envelope of a row: sites in apex[0 .. count), apex[i] rules from column from[i] on. Returns the count.
std::uint32_t lower_envelope(std::uint32_t width, const std::uint32_t* in, std::uint32_t* apex, std::uint32_t* from) {
  std::uint32_t count = 0;
  for (std::uint32_t x = 0; x < width; ++x) {
    if (in[x] == kNoSeed) {
      continue;
    }
    const std::int64_t sq = static_cast<std::int64_t>(in[x]) * in[x];
    std::int64_t start = 0;
    while (count > 0) {
      const std::uint32_t top = apex[count - 1];
      start = envelope_crossing(top, static_cast<std::int64_t>(in[top]) * in[top], x, sq);
      if (start > from[count - 1]) {
        break;
      }
      --count;
      start = 0;
    }
    if (start < width) {
      apex[count] = x;
      from[count] = static_cast<std::uint32_t>(start < 0 ? 0 : start);
      ++count;
    }
  }
  return count;
}

/// A row by its lower envelope; apex and from are scratch of the row's width.
inline void envelope_row(std::uint32_t width, const std::uint32_t* in, std::uint32_t* out, std::uint32_t* apex,
                         std::uint32_t* from) {
  const std::uint32_t count = lower_envelope(width, in, apex, from);
  std::uint32_t end = width;
  for (std::uint32_t i = count; i-- > 0;) {
    const std::uint32_t sq_apex = in[apex[i]] * in[apex[i]];
    for (std::uint32_t x = from[i]; x < end; ++x) {
      const std::uint32_t dx = x - apex[i];  // modulo 2^32 its sign does not matter
      out[x] = dx * dx + sq_apex;
    }
    end = from[i];
  }
  for (std::uint32_t x = 0; count == 0 && x < width; ++x) {
    out[x] = kNoSeed;
  }
}

static_assert(kEdtFullReach % kEdtOffsets == 0, "the search must not leave the margins");
/// Searching needs vectors with a minimum of 32-bit integers; without, the envelope is faster always.
constexpr bool kSearchFullRows = GDTSLAM_ISA_LEVEL > 0;
/// The square of a column without a seed: more than any sum of two squares within the limits, and still positive as
/// int32 when a squared offset of the search is added.
constexpr std::int32_t kNoSquare = 0x60000000;

/// Minimum over offsets for one tile of squares; false when offsets beyond the reach could still improve it. `least` is
/// the row's smallest square.
inline bool search_full_tile(const std::int32_t* squares, std::int32_t least, std::int32_t* __restrict best) {
  for (std::uint32_t i = 0; i < kEdtTile; ++i) {
    best[i] = squares[i];
  }
  for (std::uint32_t dx = 1; dx < kEdtFullReach; dx += kEdtOffsets) {
    std::int32_t most = 0;
    for (std::uint32_t i = 0; i < kEdtTile; ++i) {
      most = most > best[i] ? most : best[i];
    }
    if (static_cast<std::int32_t>(dx * dx) + least >= most) {
      return true;
    }
    for (std::uint32_t next = dx; next < dx + kEdtOffsets; ++next) {
      const auto sq = static_cast<std::int32_t>(next * next);
      const std::int32_t* left = squares - next;
      const std::int32_t* right = squares + next;
      for (std::uint32_t i = 0; i < kEdtTile; ++i) {
        const std::int32_t beside = (left[i] < right[i] ? left[i] : right[i]) + sq;
        best[i] = beside < best[i] ? beside : best[i];
      }
    }
  }
  return false;
}

/// Squares of a row's column distances; returns the smallest.
inline std::int32_t square_row(const std::uint32_t* __restrict in, std::uint32_t width,
                               std::int32_t* __restrict squares) {
  std::int32_t least = kNoSquare;
  for (std::uint32_t x = 0; x < width; ++x) {
    const std::int32_t sq = in[x] == kNoSeed ? kNoSquare : static_cast<std::int32_t>(in[x] * in[x]);
    squares[x] = sq;
    least = sq < least ? sq : least;
  }
  return least;
}

/// Searches all tiles of a row, the one that failed last time first; false when one fails.
inline bool search_row(std::uint32_t width, const std::int32_t* squares, std::int32_t least, std::uint32_t* out,
                       std::uint32_t& failed_tile) {
  const auto tiles = static_cast<std::uint32_t>(edt_tiled_width(width) / kEdtTile);
  for (std::uint32_t i = 0; i < tiles; ++i) {
    const std::uint32_t tile = i + failed_tile < tiles ? i + failed_tile : i + failed_tile - tiles;
    std::int32_t best[kEdtTile];
    if (!search_full_tile(squares + tile * kEdtTile, least, best)) {
      failed_tile = tile;
      return false;
    }
    const std::uint32_t first = tile * kEdtTile;
    __builtin_memcpy(out + first, best, lesser(kEdtTile, width - first) * sizeof(std::uint32_t));
  }
  return true;
}

void edt_full_rows(const EdtFullRows::Params& params, const std::uint32_t* distance, std::uint32_t* sq_distance,
                   std::uint32_t begin, std::uint32_t end, std::int32_t* scratch, std::uint32_t* envelope) {
  for (std::size_t i = 0; i < edt_full_rows_squares(params); ++i) {
    scratch[i] = kNoSquare;
  }
  std::int32_t* squares = scratch + kEdtFullReach;
  std::uint32_t failed_tile = 0;
  for (std::uint32_t y = begin; y < end; ++y) {
    const std::uint32_t* in = distance + at(params.stride, y);
    std::uint32_t* out = sq_distance + at(params.stride, y);
    bool found = false;
    if constexpr (kSearchFullRows) {
      const std::int32_t least = square_row(in, params.width, squares);
      found = least != kNoSquare && search_row(params.width, squares, least, out, failed_tile);
    }
    if (!found) {
      envelope_row(params.width, in, out, envelope, envelope + params.width);
    }
  }
}
