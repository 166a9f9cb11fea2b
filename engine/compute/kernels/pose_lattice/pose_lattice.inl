// The samples of a window, which of them are local minima, and the few smallest of many values.

/// One part of the prior's cost, limited; NaN counts as the limit.
inline float limited(float cost, float limit) { return cost < limit ? cost : limit; }

/// A sample's coordinate along one axis.
inline float lattice_coordinate(float centre, std::uint32_t i, std::uint32_t count, float step) {
  // Both are below 2^31: the signed conversion gives the same float, and vector instructions support it.
  const auto place = static_cast<float>(static_cast<std::int32_t>(i));
  const auto middle = static_cast<float>(static_cast<std::int32_t>(count / 2));
  return centre + (place - middle) * step;
}

/// Values that all samples of one row share.
struct LatticeRow {
  float y;
  float theta;
  float sq_dy;
  float turn_cost;  ///< cost of the turn by the prior, limited
};

/// `count` samples of a row from column `begin` on.
void lattice_row(const PoseLattice::Params& params, const LatticeRow& row, std::uint32_t begin, std::uint32_t count,
                 PoseCandidate* candidates) {
  const PoseLattice::Params p = params;
  const LatticeRow shared = row;
  PoseCandidate* __restrict out = candidates;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = lattice_coordinate(p.centre_x, begin + static_cast<std::uint32_t>(i), p.count_xy, p.step_cells);
    const float dx = x - p.prior.mean_x;
    const float shift_cost = limited((dx * dx + shared.sq_dy) * p.prior.weight_xy, p.prior.limit);
    out[i].x = x;
    out[i].y = shared.y;
    out[i].theta = shared.theta;
    // At most 2e9, which int32 holds.
    out[i].bias = static_cast<std::uint32_t>(static_cast<std::int32_t>(shift_cost + shared.turn_cost));
  }
}

void pose_lattice(const PoseLattice::Params& params, PoseCandidate* candidates, Slice samples) {
  const std::uint32_t n = params.count_xy;
  for (std::uint32_t first = samples.begin; first < samples.end;) {
    const std::uint32_t row = first / n;
    const std::uint32_t column = first % n;
    const std::uint32_t last = lesser(samples.end, first - column + n);
    LatticeRow shared{};
    shared.y = lattice_coordinate(params.centre_y, row % n, n, params.step_cells);
    shared.theta = lattice_coordinate(params.centre_theta, row / n, params.count_theta, params.step_rad);
    const float dy = shared.y - params.prior.mean_y;
    const float dt = shared.theta - params.prior.mean_theta;
    shared.sq_dy = dy * dy;
    shared.turn_cost = limited((dt * dt) * params.prior.weight_theta, params.prior.limit);
    lattice_row(params, shared, column, last - first, candidates + first);
    first = last;
  }
}

/// Samples of a row processed together.
constexpr std::uint32_t kMinimaTile = 256;

/// The least costs among the neighbours of each sample in a tile: those of lower and those of higher index.
struct MinimaTile {
  alignas(64) std::uint32_t before[kMinimaTile];
  alignas(64) std::uint32_t after[kMinimaTile];
};

/// Lowers `least` to the three neighbours in another row, of `width` samples, for columns [begin, end).
void lower_to_row(const std::uint32_t* row, std::uint32_t width, std::uint32_t begin, std::uint32_t end,
                  std::uint32_t* least) {
  const std::uint32_t skipped = begin == 0 ? 1 : 0;  // the first and the last column lack a side
  const std::uint32_t inner_end = end < width ? end : width - 1;
  const std::size_t inner = inner_end > begin + skipped ? inner_end - begin - skipped : 0;
  const std::uint32_t* __restrict in = row + begin + skipped;
  std::uint32_t* __restrict out = least + skipped;
  for (std::size_t i = 0; i < inner; ++i) {
    out[i] = lesser(lesser(out[i], in[i]), lesser((in - 1)[i], in[i + 1]));
  }
  if (begin == 0) {
    least[0] = lesser(least[0], lesser(row[0], row[width > 1 ? 1 : 0]));
  }
  if (end == width) {
    const std::uint32_t x = width - 1;
    least[x - begin] = lesser(least[x - begin], lesser(row[x], row[x > 0 ? x - 1 : 0]));
  }
}

/// Starts both with the neighbours in the samples' own row. A missing neighbour is kNoCost, which beats nothing.
void start_tile(const std::uint32_t* row, std::uint32_t width, std::uint32_t begin, std::uint32_t end,
                MinimaTile& tile) {
  const std::uint32_t count = end - begin;
  for (std::uint32_t i = begin == 0 ? 1 : 0; i < count; ++i) {
    tile.before[i] = row[begin + i - 1];
  }
  for (std::uint32_t i = 0; i < count - (end == width ? 1 : 0); ++i) {
    tile.after[i] = row[begin + i + 1];
  }
  if (begin == 0) {
    tile.before[0] = kNoCost;
  }
  if (end == width) {
    tile.after[count - 1] = kNoCost;
  }
}

/// Columns [begin, end) of a row, at most a tile; `row_index` counts rows over all angles.
void minima_of_tile(const LatticeMinima::Params& params, const std::uint32_t* cost, std::uint32_t row_index,
                    std::uint32_t begin, std::uint32_t end, std::uint32_t* minima) {
  const std::uint32_t n = params.count_xy;
  const std::uint32_t y = row_index % n;
  const std::uint32_t t = row_index / n;
  const std::uint32_t* row = cost + at(n, row_index);
  MinimaTile tile;
  start_tile(row, n, begin, end, tile);
  for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < n; ++v) {
    const std::uint32_t* beside = cost + at(n, t * n + v);
    if (t > 0) {
      lower_to_row(beside - at(n, n), n, begin, end, tile.before);
    }
    if (v != y) {
      lower_to_row(beside, n, begin, end, v < y ? tile.before : tile.after);
    }
    if (t + 1 < params.count_theta) {
      lower_to_row(beside + at(n, n), n, begin, end, tile.after);
    }
  }
  std::uint32_t* __restrict out = minima + at(n, row_index) + begin;
  const std::uint32_t* __restrict own = row + begin;
  for (std::size_t i = 0; i < end - begin; ++i) {
    const bool stays = (own[i] < tile.before[i]) & (own[i] <= tile.after[i]);
    out[i] = stays ? own[i] : kNoCost;
  }
}

void lattice_minima(const LatticeMinima::Params& params, const std::uint32_t* cost, std::uint32_t* minima,
                    Slice samples) {
  const std::uint32_t n = params.count_xy;
  for (std::uint32_t first = samples.begin; first < samples.end;) {
    const std::uint32_t row = first / n;
    const std::uint32_t column = first % n;
    const std::uint32_t count = lesser(lesser(n - column, samples.end - first), kMinimaTile);
    minima_of_tile(params, cost, row, column, column + count, minima);
    first += count;
  }
}

/// Whole blocks are tested for values that could enter the list, which is rare.
constexpr std::uint32_t kSmallestBlock = 64;

/// The smallest values so far, ascending; missing entries are kNoCost.
struct SmallestList {
  std::uint32_t value[SmallestValues::kMost];
  std::uint32_t index[SmallestValues::kMost];
  std::uint32_t wanted;
};

/// Inserts a value below the last one, after equal ones: they came earlier.
void insert_small(SmallestList& list, std::uint32_t value, std::uint32_t index) {
  std::uint32_t place = list.wanted - 1;
  while (place > 0 && list.value[place - 1] > value) {
    list.value[place] = list.value[place - 1];
    list.index[place] = list.index[place - 1];
    --place;
  }
  list.value[place] = value;
  list.index[place] = index;
}

void insert_smaller(SmallestList& list, const std::uint32_t* values, std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t i = begin; i < end; ++i) {
    if (values[i] < list.value[list.wanted - 1]) {
      insert_small(list, values[i], i);
    }
  }
}

void smallest_values(const SmallestValues::Params& params, const std::uint32_t* values, std::uint32_t* picks) {
  SmallestList list;
  list.wanted = params.wanted;
  for (std::uint32_t i = 0; i < params.wanted; ++i) {
    list.value[i] = kNoCost;
    list.index[i] = kNoCost;
  }
  const std::uint32_t whole = params.count - params.count % kSmallestBlock;
  for (std::uint32_t first = 0; first < whole; first += kSmallestBlock) {
    std::uint32_t least = kNoCost;
    for (std::uint32_t i = 0; i < kSmallestBlock; ++i) {
      least = lesser(least, values[first + i]);
    }
    if (least < list.value[list.wanted - 1]) {
      insert_smaller(list, values, first, first + kSmallestBlock);
    }
  }
  insert_smaller(list, values, whole, params.count);
  for (std::uint32_t i = 0; i < params.wanted; ++i) {
    picks[2 * i] = list.value[i];
    picks[2 * i + 1] = list.index[i];
  }
}
