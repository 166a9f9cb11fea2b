// Points on lines (point_to_line.hpp). Plain loops over blocks of points that become vectors.

constexpr std::uint32_t kLineBlock = 128;
constexpr float kLeastLength = 1.0e-18F;  // a point nearer to the robot has no direction

/// Points in the frame of the lines.
struct PlacedPoints {
  alignas(64) float x[kLineBlock];
  alignas(64) float y[kLineBlock];
  alignas(64) float direction[kLineBlock];
  alignas(64) std::int32_t bin[kLineBlock];
};

/// The points that are taken from the moving scan.
struct TakenPoints {
  const float* x;
  const float* y;
  const float* normal_x;
  const float* normal_y;
  std::uint32_t every;
  std::uint32_t count;
};

inline TakenPoints taken_points(const PointToLine::Scan& scan, std::uint32_t every, std::uint32_t count) {
  const float* const x = scan.values;
  return {x, x + scan.count, x + 2 * std::size_t{scan.count}, x + 3 * std::size_t{scan.count}, every, count};
}

inline void place_points(const PointToLine::Pose& pose, const TakenPoints& taken, std::uint32_t first,
                         std::uint32_t count, PlacedPoints& placed) {
  const float* from_x = taken.x + static_cast<std::size_t>(first) * taken.every;
  const float* from_y = taken.y + static_cast<std::size_t>(first) * taken.every;
  constexpr float kBinsAUnit = static_cast<float>(PointToLine::kBins) / 4.0F;
  constexpr float kLastBin = static_cast<float>(PointToLine::kBins) - 1.0F;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float px = from_x[i * taken.every];
    const float py = from_y[i * taken.every];
    const float x = (pose.cos * px - pose.sin * py) + pose.x;
    const float y = (pose.sin * px + pose.cos * py) + pose.y;
    const float length = (x < 0.0F ? -x : x) + (y < 0.0F ? -y : y);
    const float share = y * reciprocal(length > kLeastLength ? length : 1.0F);
    const float behind = (y < 0.0F ? -2.0F : 2.0F) - share;
    const float direction = x >= 0.0F ? share : behind;
    const float bin = (direction + 2.0F) * kBinsAUnit;
    const float above = bin > 0.0F ? bin : 0.0F;
    placed.x[i] = x;
    placed.y[i] = y;
    placed.direction[i] = direction;
    placed.bin[i] = static_cast<std::int32_t>(above < kLastBin ? above : kLastBin);
  }
}

/// Squared distance and number of the nearest candidate: the number in the lowest bits.
#if GDTSLAM_ISA_LEVEL > 0
inline std::uint32_t nearest_candidate(const float* xs, const float* ys, float x, float y) {
  const Floats at_x = all(x);
  const Floats at_y = all(y);
  Ints least = all(0x7FFFFFFF);
  for (std::uint32_t k = 0; k < PointToLine::kCandidates; k += kLanes) {
    const Floats dx = sub(load_floats(xs + k), at_x);
    const Floats dy = sub(load_floats(ys + k), at_y);
    const Ints square = bits_of(add(mul(dx, dx), mul(dy, dy)));
    const Ints number = add(lane_numbers(), all(static_cast<std::int32_t>(k)));
    least = lesser(least, add(both(square, all(~static_cast<std::int32_t>(PointToLine::kCandidates - 1U))), number));
  }
  return lane_least(least);
}
#else
inline std::uint32_t nearest_candidate(const float* xs, const float* ys, float x, float y) {
  std::uint32_t least = 0xFFFFFFFFU;
  for (std::uint32_t k = 0; k < PointToLine::kCandidates; ++k) {
    const float dx = xs[k] - x;
    const float dy = ys[k] - y;
    const float square = dx * dx + dy * dy;
    const std::uint32_t bits = __builtin_bit_cast(std::uint32_t, square);
    least = lesser(least, (bits & ~(PointToLine::kCandidates - 1U)) + k);
  }
  return least;
}
#endif

inline void find_block(const PointToLine::Params& params, const PointToLine::Pose& pose,
                       const PointToLine::Scan& fixed, const TakenPoints& taken, std::uint32_t first,
                       std::uint32_t count, std::int32_t* found) {
  const auto last = static_cast<std::int32_t>(fixed.count - PointToLine::kCandidates);
  const std::uint32_t gate = __builtin_bit_cast(std::uint32_t, params.gate_m2);
  const float* const y = fixed.values + fixed.count;
  PlacedPoints placed;
  place_points(pose, taken, first, count, placed);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t start = clamped(fixed.bins[placed.bin[i]] - PointToLine::kBefore, 0, last);
    const std::uint32_t key = nearest_candidate(fixed.values + start, y + start, placed.x[i], placed.y[i]);
    const bool is_seen = placed.direction[i] >= fixed.low && placed.direction[i] <= fixed.high;
    const auto nearest = start + static_cast<std::int32_t>(key & (PointToLine::kCandidates - 1U));
    found[i] = is_seen && key < gate ? nearest : PointToLine::kNone;
  }
}

void find_lines(const PointToLine::Params& params, const PointToLine::Pose& pose, const PointToLine::Scan& fixed,
                const PointToLine::Scan& moving, std::uint32_t every, std::uint32_t taken, std::int32_t* found) {
  const TakenPoints points = taken_points(moving, every, taken);
  for (std::uint32_t first = 0; first < taken; first += kLineBlock) {
    find_block(params, pose, fixed, points, first, lesser(kLineBlock, taken - first), found + first);
  }
}

/// Points and their lines.
struct PointsOnLines {
  alignas(64) float x[kLineBlock];
  alignas(64) float y[kLineBlock];
  alignas(64) float normal_x[kLineBlock];
  alignas(64) float normal_y[kLineBlock];
  alignas(64) float line_x[kLineBlock];
  alignas(64) float line_y[kLineBlock];
  alignas(64) float line_normal_x[kLineBlock];
  alignas(64) float line_normal_y[kLineBlock];
  alignas(64) float counts[kLineBlock];
};

/// Fills whole lanes; those behind the last point do not count.
inline std::uint32_t collect_points(const TakenPoints& lines, const TakenPoints& taken, std::uint32_t first,
                                    std::uint32_t count, const std::int32_t* found, PointsOnLines& block) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t point = static_cast<std::size_t>(first + i) * taken.every;
    const std::int32_t line = found[i] < 0 ? 0 : found[i];
    block.x[i] = taken.x[point];
    block.y[i] = taken.y[point];
    block.normal_x[i] = taken.normal_x[point];
    block.normal_y[i] = taken.normal_y[point];
    block.line_x[i] = lines.x[line];
    block.line_y[i] = lines.y[line];
    block.line_normal_x[i] = lines.normal_x[line];
    block.line_normal_y[i] = lines.normal_y[line];
    block.counts[i] = found[i] < 0 ? 0.0F : 1.0F;
  }
  const std::uint32_t whole = (count + PointToLine::kLanes - 1) / PointToLine::kLanes * PointToLine::kLanes;
  for (std::uint32_t i = count; i < whole; ++i) {
    block.x[i] = block.y[i] = block.normal_x[i] = block.normal_y[i] = 0.0F;
    block.line_x[i] = block.line_y[i] = block.line_normal_x[i] = block.line_normal_y[i] = block.counts[i] = 0.0F;
  }
  return whole;
}

struct LineSums {
  alignas(64) float lanes[PointToLine::kSums][PointToLine::kLanes];
};

inline void add_points(const PointToLine::Params& params, const PointToLine::Pose& pose, std::uint32_t count,
                       const PointsOnLines& block, LineSums& sums) {
  count = count / PointToLine::kLanes * PointToLine::kLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t first = 0; first < count; first += PointToLine::kLanes) {
    for (std::uint32_t lane = 0; lane < PointToLine::kLanes; ++lane) {
      const std::uint32_t i = first + lane;
      const float px = block.x[i];
      const float py = block.y[i];
      const float nx = block.line_normal_x[i];
      const float ny = block.line_normal_y[i];
      const float x = (pose.cos * px - pose.sin * py) + pose.x;
      const float y = (pose.sin * px + pose.cos * py) + pose.y;
      const float off = nx * (x - block.line_x[i]) + ny * (y - block.line_y[i]);
      // The normal of the line in the frame of the points.
      const float jx = pose.cos * nx + pose.sin * ny;
      const float jy = pose.cos * ny - pose.sin * nx;
      const float jt = px * jy - py * jx;
      const float cosine = jx * block.normal_x[i] + jy * block.normal_y[i];
      const float share = reciprocal(1.0F + (off * off) * params.per_kernel_m2);
      const float weight = cosine >= params.least_cosine ? block.counts[i] * (share * share) : 0.0F;
      const float pull = weight * off;
      const float wx = weight * jx;
      const float wy = weight * jy;
      sums.lanes[0][lane] += wx * jx;
      sums.lanes[1][lane] += wx * jy;
      sums.lanes[2][lane] += wx * jt;
      sums.lanes[3][lane] += wy * jy;
      sums.lanes[4][lane] += wy * jt;
      sums.lanes[5][lane] += (weight * jt) * jt;
      sums.lanes[6][lane] += pull * jx;
      sums.lanes[7][lane] += pull * jy;
      sums.lanes[8][lane] += pull * jt;
      sums.lanes[9][lane] += weight;
      sums.lanes[10][lane] += pull * off;
    }
  }
}

inline void write_sums(LineSums& sums, float* totals) {
  for (std::size_t k = 0; k < PointToLine::kSums; ++k) totals[k] = lane_tree<PointToLine::kLanes>(sums.lanes[k]);
}

void line_slope(const PointToLine::Params& params, const PointToLine::Pose& pose, const PointToLine::Scan& fixed,
                const PointToLine::Scan& moving, std::uint32_t every, std::uint32_t taken, const std::int32_t* found,
                float* totals) {
  const TakenPoints points = taken_points(moving, every, taken);
  const TakenPoints lines = taken_points(fixed, 1, fixed.count);
  LineSums sums{};
  PointsOnLines block;
  for (std::uint32_t first = 0; first < taken; first += kLineBlock) {
    const std::uint32_t count = lesser(kLineBlock, taken - first);
    add_points(params, pose, collect_points(lines, points, first, count, found + first, block), block, sums);
  }
  write_sums(sums, totals);
}

void point_to_line(const PointToLine::Params& params, const float* values, const std::uint16_t* bins,
                   const PointToLine::Pair* pairs, float* sums, Slice slice) {
  std::int32_t found[kLineBlock];
  PointsOnLines block;
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    const PointToLine::Pair& pair = pairs[i];
    const PointToLine::Scan fixed{values + pair.fixed, pair.fixed_count, bins + pair.bins, pair.low, pair.high};
    const PointToLine::Scan moving{values + pair.moving, pair.moving_count, nullptr, 0.0F, 0.0F};
    const TakenPoints points = taken_points(moving, pair.every, pair.taken);
    const TakenPoints lines = taken_points(fixed, 1, fixed.count);
    LineSums lanes{};
    for (std::uint32_t first = 0; first < pair.taken; first += kLineBlock) {
      const std::uint32_t count = lesser(kLineBlock, pair.taken - first);
      find_block(params, pair.found, fixed, points, first, count, found);
      add_points(params, pair.at, collect_points(lines, points, first, count, found, block), block, lanes);
    }
    write_sums(lanes, sums + PointToLine::kSums * i);
  }
}
