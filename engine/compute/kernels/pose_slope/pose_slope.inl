// The cost of a pose with its slope (pose_slope.hpp). Three steps for a block of points: position, look-up, sums; plain
// loops over whole lanes that become vectors. The lanes are those of the header on every instruction set, so that sums
// of float32 have the same bits.

constexpr std::uint32_t kSlopeLanes = PoseSlope::kLanes;
constexpr std::uint32_t kSlopeBlock = 8 * kSlopeLanes;

struct SlopeBlock {
  alignas(64) float turned_x[kSlopeBlock];  ///< the point turned into the directions of the map
  alignas(64) float turned_y[kSlopeBlock];
  alignas(64) float fraction_x[kSlopeBlock];
  alignas(64) float fraction_y[kSlopeBlock];
  alignas(64) float counts[kSlopeBlock];  ///< 1, or 0 after the last point
  alignas(64) std::uint32_t cell[kSlopeBlock];
  alignas(64) std::uint32_t lower[kSlopeBlock];  ///< two neighbours in the row, in memory order
  alignas(64) std::uint32_t upper[kSlopeBlock];
};

/// Sums of the lanes, mostly in registers.
struct SlopeSums {
  alignas(64) float lanes[PoseSlope::kSums][kSlopeLanes];
};

inline void locate_slopes(const PoseCost::Params& grid, const CostPose& pose, const PointCells* points,
                          std::uint32_t count, SlopeBlock& block) {
  const auto anchor_x = static_cast<float>(grid.anchor_x);
  const auto anchor_y = static_cast<float>(grid.anchor_y);
  const auto last_x = static_cast<float>(grid.width - 2);
  const auto last_y = static_cast<float>(grid.height - 2);
  const std::uint32_t stride = grid.stride;
  const std::uint32_t strip_step = grid.strip - kStripWidth;
  const float s = pose.s;
  const float c = pose.c;
  const float to_x = pose.x;
  const float to_y = pose.y;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = c * points[i].x - s * points[i].y;
    const float y = s * points[i].x + c * points[i].y;
    const float u = (x + to_x) - 0.5F;
    const float v = (y + to_y) - 0.5F;
    const auto floor_u = static_cast<float>(floor_position(u));
    const auto floor_v = static_cast<float>(floor_position(v));
    const float wanted_x = floor_u + anchor_x;
    const float wanted_y = floor_v + anchor_y;
    const float above_x = wanted_x > 0.0F ? wanted_x : 0.0F;
    const float above_y = wanted_y > 0.0F ? wanted_y : 0.0F;
    const float held_x = above_x < last_x ? above_x : last_x;
    const float held_y = above_y < last_y ? above_y : last_y;
    block.turned_x[i] = x;
    block.turned_y[i] = y;
    block.fraction_x[i] = held_x == wanted_x ? u - floor_u : 0.0F;
    block.fraction_y[i] = held_y == wanted_y ? v - floor_v : 0.0F;
    block.counts[i] = 1.0F;
    block.cell[i] = field_place(static_cast<std::uint32_t>(static_cast<std::int32_t>(held_x)),
                             static_cast<std::uint32_t>(static_cast<std::int32_t>(held_y)), stride, strip_step);
  }
}

/// Fills a block up to whole lanes with points that do not count: they read the corner, which holds the cap.
inline std::uint32_t fill_up(std::uint32_t count, SlopeBlock& block) {
  const std::uint32_t whole = (count + kSlopeLanes - 1) / kSlopeLanes * kSlopeLanes;
  for (std::uint32_t i = count; i < whole; ++i) {
    block.turned_x[i] = block.turned_y[i] = block.fraction_x[i] = block.fraction_y[i] = block.counts[i] = 0.0F;
    block.cell[i] = 0;
  }
  return whole;
}

inline void look_up_slopes(const std::uint16_t* field, std::uint32_t stride, std::uint32_t count, SlopeBlock& block) {
  const std::uint16_t* row_above = field + stride;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t cell = block.cell[i];
    __builtin_memcpy(&block.lower[i], field + cell, 4);
    __builtin_memcpy(&block.upper[i], row_above + cell, 4);
  }
}

/// The left and the right cell of a pair.
inline float left_cell(std::uint32_t pair) { return cell_of_pair(pair, false, 0xFFFFU); }
inline float right_cell(std::uint32_t pair) { return cell_of_pair(pair, true, 0xFFFFU); }

inline void add_slopes(float cap, std::uint32_t blank, float scale, std::uint32_t count, const SlopeBlock& block, SlopeSums& sums) {
  count = count / kSlopeLanes * kSlopeLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t first = 0; first < count; first += kSlopeLanes) {
    for (std::uint32_t lane = 0; lane < kSlopeLanes; ++lane) {
      const std::uint32_t i = first + lane;
      const std::uint32_t lower = block.lower[i] ^ blank;
      const std::uint32_t upper = block.upper[i] ^ blank;
      const float v00 = left_cell(lower);
      const float v10 = right_cell(lower);
      const float v01 = left_cell(upper);
      const float v11 = right_cell(upper);
      const float fx = block.fraction_x[i];
      const float fy = block.fraction_y[i];
      const float bottom = v00 + fx * (v10 - v00);
      const float top = v01 + fx * (v11 - v01);
      const float left = v00 + fy * (v01 - v00);
      const float right = v10 + fy * (v11 - v10);
      const float between = bottom + fy * (top - bottom);
      const float counts = block.counts[i];
      const float slopes = between < cap ? counts : 0.0F;
      const float value = between < cap ? between : cap;
      const float gx = slopes * (right - left);
      const float gy = slopes * (top - bottom);
      const float gt = gy * block.turned_x[i] - gx * block.turned_y[i];
      const float weight = 1.0F / (value > scale ? value : scale);
      const float pull = weight * value;
      const float robust = value < scale ? 0.5F * value * pull : value - 0.5F * scale;
      const float wx = weight * gx;
      const float wy = weight * gy;
      sums.lanes[0][lane] += counts * robust;
      sums.lanes[1][lane] += pull * gx;
      sums.lanes[2][lane] += pull * gy;
      sums.lanes[3][lane] += pull * gt;
      sums.lanes[4][lane] += wx * gx;
      sums.lanes[5][lane] += wx * gy;
      sums.lanes[6][lane] += wx * gt;
      sums.lanes[7][lane] += wy * gy;
      sums.lanes[8][lane] += wy * gt;
      sums.lanes[9][lane] += (weight * gt) * gt;
    }
  }
}

void pose_slope(const PoseSlope::Params& params, const std::uint16_t* field, const PointCells* points,
                const PoseSlope::Pose& pose, double* totals) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  const CostPose at{rotation.sin, rotation.cos, pose.x, pose.y};
  const PoseCost::Params& grid = params.grid;
  SlopeBlock block;
  SlopeSums sums{};
  const std::uint32_t blank = grid.blank << 16U | grid.blank;
  for (std::uint32_t first = 0; first < grid.point_count; first += kSlopeBlock) {
    const std::uint32_t count = lesser(kSlopeBlock, grid.point_count - first);
    locate_slopes(grid, at, points + first, count, block);
    const std::uint32_t whole = fill_up(count, block);
    look_up_slopes(field, grid.stride, whole, block);
    add_slopes(static_cast<float>(grid.cap), blank, params.scale, whole, block, sums);
  }
  for (std::size_t k = 0; k < PoseSlope::kSums; ++k) {
    totals[k] = 0.0;
    for (const float lane : sums.lanes[k]) totals[k] += static_cast<double>(lane);
  }
}
