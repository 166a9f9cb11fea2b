// Points on lines (point_to_line.hpp). Plain loops over blocks of points that become vectors.

constexpr std::uint32_t kLineBlock = 128;

/// Points in the frame of the lines.
struct PlacedPoints {
  alignas(64) float x[kLineBlock];
  alignas(64) float y[kLineBlock];
  alignas(64) float direction[kLineBlock];
  alignas(64) std::int32_t bin[kLineBlock];
};

inline void place_points(const PointToLine::Params& params, const PointToLine::Point* points, std::uint32_t first,
                         std::uint32_t count, PlacedPoints& placed) {
  const PointToLine::Point* from = points + static_cast<std::size_t>(first) * params.every;
  constexpr float kBinsAUnit = static_cast<float>(PointToLine::kBins) / 4.0F;
  constexpr auto kLastBin = static_cast<std::int32_t>(PointToLine::kBins) - 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float px = from[i * params.every].x;
    const float py = from[i * params.every].y;
    const float x = params.cos * px - params.sin * py + params.x;
    const float y = params.sin * px + params.cos * py + params.y;
    const float length = (x < 0.0F ? -x : x) + (y < 0.0F ? -y : y);
    const float share = y / (length > 0.0F ? length : 1.0F);
    const float behind = (y < 0.0F ? -2.0F : 2.0F) - share;
    const float direction = x >= 0.0F ? share : behind;
    placed.x[i] = x;
    placed.y[i] = y;
    placed.direction[i] = direction;
    placed.bin[i] = clamped(static_cast<std::int32_t>((direction + 2.0F) * kBinsAUnit), 0, kLastBin);
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

void find_lines(const PointToLine::Params& params, const PointToLine::Lines& lines, const PointToLine::Point* points,
                std::int32_t* found) {
  const std::int32_t last = lines.count - static_cast<std::int32_t>(PointToLine::kCandidates);
  const float gate = params.gate_m * params.gate_m;
  PlacedPoints placed;
  for (std::uint32_t first = 0; first < params.point_count; first += kLineBlock) {
    const std::uint32_t count = lesser(kLineBlock, params.point_count - first);
    place_points(params, points, first, count, placed);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::int32_t start = clamped(lines.first[placed.bin[i]] - PointToLine::kBefore, 0, last);
      const std::uint32_t key =
          nearest_candidate(lines.x + start, lines.y + start, placed.x[i], placed.y[i]);
      const bool is_seen = placed.direction[i] >= lines.low && placed.direction[i] <= lines.high;
      const bool is_near = __builtin_bit_cast(float, key) < gate;
      const auto nearest = start + static_cast<std::int32_t>(key & (PointToLine::kCandidates - 1U));
      found[first + i] = is_seen && is_near ? nearest : PointToLine::kNone;
    }
  }
}

/// Points and their lines.
struct PointsOnLines {
  alignas(64) PointToLine::Point points[kLineBlock];
  alignas(64) PointToLine::Point lines[kLineBlock];
  alignas(64) float counts[kLineBlock];
};

/// Fills whole lanes; those behind the last point do not count.
inline std::uint32_t collect_points(const PointToLine::Point* lines, const PointToLine::Point* points,
                                    std::uint32_t every, std::uint32_t first, std::uint32_t count,
                                    const std::int32_t* found, PointsOnLines& block) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t line = found[first + i];
    __builtin_memcpy(&block.points[i], &points[static_cast<std::size_t>(first + i) * every], sizeof(PointToLine::Point));
    __builtin_memcpy(&block.lines[i], &lines[line < 0 ? 0 : line], sizeof(PointToLine::Point));
    block.counts[i] = line < 0 ? 0.0F : 1.0F;
  }
  const std::uint32_t whole = (count + PointToLine::kLanes - 1) / PointToLine::kLanes * PointToLine::kLanes;
  for (std::uint32_t i = count; i < whole; ++i) {
    block.points[i] = block.lines[i] = {};
    block.counts[i] = 0.0F;
  }
  return whole;
}

struct LineSums {
  alignas(64) float lanes[PointToLine::kSums][PointToLine::kLanes];
};

inline void add_points(const PointToLine::Params& params, std::uint32_t count, const PointsOnLines& block,
                       LineSums& sums) {
  const float per_kernel = 1.0F / (params.kernel_m * params.kernel_m);
  count = count / PointToLine::kLanes * PointToLine::kLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t first = 0; first < count; first += PointToLine::kLanes) {
    for (std::uint32_t lane = 0; lane < PointToLine::kLanes; ++lane) {
      const std::uint32_t i = first + lane;
      const float px = block.points[i].x;
      const float py = block.points[i].y;
      const float nx = block.lines[i].normal_x;
      const float ny = block.lines[i].normal_y;
      const float x = params.cos * px - params.sin * py + params.x;
      const float y = params.sin * px + params.cos * py + params.y;
      const float off = nx * (x - block.lines[i].x) + ny * (y - block.lines[i].y);
      // The normal of the line in the frame of the points.
      const float jx = params.cos * nx + params.sin * ny;
      const float jy = params.cos * ny - params.sin * nx;
      const float jt = px * jy - py * jx;
      const float cosine = jx * block.points[i].normal_x + jy * block.points[i].normal_y;
      const float share = 1.0F / (1.0F + off * off * per_kernel);
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

void line_slope(const PointToLine::Params& params, const PointToLine::Lines& lines, const PointToLine::Point* points,
                const std::int32_t* found, double* totals) {
  LineSums sums{};
  PointsOnLines block;
  for (std::uint32_t first = 0; first < params.point_count; first += kLineBlock) {
    const std::uint32_t count = lesser(kLineBlock, params.point_count - first);
    add_points(params, collect_points(lines.points, points, params.every, first, count, found, block), block, sums);
  }
  for (std::size_t k = 0; k < PointToLine::kSums; ++k) {
    totals[k] = 0.0;
    for (const float lane : sums.lanes[k]) totals[k] += static_cast<double>(lane);
  }
}
