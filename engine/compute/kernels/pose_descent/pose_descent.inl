// The descent of a pose (pose_descent.hpp). Three steps for a block of points: position, look-up, sums; plain loops over
// whole vectors that the compiler makes wide. Every instruction set has the header's lanes, and so the same sums.

constexpr std::uint32_t kSlopeLanes = PoseDescent::kLanes;
constexpr std::uint32_t kSlopeBlock = 2 * kSlopeLanes;

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

/// Cost, gradient along x, y, theta, and curvatures xx, xy, xt, yy, yt, tt.
constexpr std::uint32_t kSlopeSums = 10;
struct SlopeLanes {
  alignas(64) float lanes[kSlopeSums][kSlopeLanes];
};

struct PoseSlope {
  float cost;
  float x, y, theta;
  float xx, xy, xt, yy, yt, tt;
};

struct DescentPose {
  float x;
  float y;
  float theta;
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

/// Width of a gate and what follows from it.
struct GateWidth {
  float width;
  float per_width;
  float most;  ///< cost of a point beyond it
};

/// 1 / value for a value from 1e-30 to 1e30, within some units in the last place.
inline float reciprocal(float value) {
  float r = __builtin_bit_cast(float, 0x7EF311C7U - __builtin_bit_cast(std::uint32_t, value));
  r = r * (2.0F - value * r);
  r = r * (2.0F - value * r);
  return r * (2.0F - value * r);
}

inline GateWidth gate_width(float width) {
  return {width, reciprocal(width), (width * width) * (1.0F / 1536.0F)};
}

inline void add_slopes(float cap, std::uint32_t blank, const GateWidth& gate, std::uint32_t count,
                       const SlopeBlock& block, SlopeLanes& sums) {
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
      const float share = value * gate.per_width;
      const float held = share < 1.0F ? share : 1.0F;
      const float q = 1.0F - held * held;
      const float weight = (q * q) * (1.0F / 256.0F);
      const float robust = gate.most * (1.0F - (q * q) * q);
      const float pull = weight * value;
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

template <std::uint32_t kCount>
inline float lane_tree(float* lanes) {
  for (std::uint32_t half = kCount / 2; half > 0; half /= 2) {
    for (std::uint32_t i = 0; i < half; ++i) lanes[i] += lanes[i + half];
  }
  return lanes[0];
}

/// One part of the prior's cost; NaN counts as the limit.
inline float limited(float cost, float limit) { return cost < limit ? cost : limit; }

/// weight * distance^2 up to the limit, beyond which the prior has no gradient.
inline void add_prior(const PriorParams& prior, const DescentPose& pose, PoseSlope& at) {
  const float dx = pose.x - prior.mean_x;
  const float dy = pose.y - prior.mean_y;
  const float dt = pose.theta - prior.mean_theta;
  const float shift = (dx * dx + dy * dy) * prior.weight_xy;
  const float turn = (dt * dt) * prior.weight_theta;
  const float pull_xy = shift < prior.limit ? 2.0F * prior.weight_xy : 0.0F;
  const float pull_t = turn < prior.limit ? 2.0F * prior.weight_theta : 0.0F;
  at.cost = at.cost + (limited(shift, prior.limit) + limited(turn, prior.limit));
  at.x = at.x + pull_xy * dx;
  at.y = at.y + pull_xy * dy;
  at.theta = at.theta + pull_t * dt;
  at.xx = at.xx + pull_xy;
  at.yy = at.yy + pull_xy;
  at.tt = at.tt + pull_t;
}

PoseSlope slope_at(const PoseDescent::Params& params, const std::uint16_t* field, const PointCells* points,
                   const GateWidth& gate, const DescentPose& pose) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  const CostPose at{rotation.sin, rotation.cos, pose.x, pose.y};
  const PoseCost::Params& grid = params.grid;
  SlopeBlock block;
  SlopeLanes sums{};
  const std::uint32_t blank = grid.blank << 16U | grid.blank;
  for (std::uint32_t first = 0; first < grid.point_count; first += kSlopeBlock) {
    const std::uint32_t count = lesser(kSlopeBlock, grid.point_count - first);
    locate_slopes(grid, at, points + first, count, block);
    const std::uint32_t whole = fill_up(count, block);
    look_up_slopes(field, grid.stride, whole, block);
    add_slopes(static_cast<float>(grid.cap), blank, gate, whole, block, sums);
  }
  float totals[kSlopeSums];
  for (std::uint32_t k = 0; k < kSlopeSums; ++k) totals[k] = lane_tree<kSlopeLanes>(sums.lanes[k]);
  PoseSlope slope{totals[0], totals[1], totals[2], totals[3], totals[4],
                  totals[5], totals[6], totals[7], totals[8], totals[9]};
  add_prior(params.prior, pose, slope);
  return slope;
}

constexpr float kFirstDamping = 1.0e-4F;
constexpr float kMostDamping = 1000.0F;
constexpr float kLeastPivot = 1.0e-20F;
constexpr float kMostCost = 2.0e9F;

/// Damping after a step that was undone or could not be computed.
inline float more_damping(float damping) { return damping < 0.25F ? 1.0F : 4.0F * damping; }

/// Solves (H + damping diag(H)) step = -gradient by LDL^T; false if the matrix is singular.
inline bool damped_step(const PoseSlope& at, float damping, DescentPose& step) {
  const float grow = 1.0F + damping;
  const float d0 = at.xx * grow;
  if (!(d0 > kLeastPivot)) return false;
  const float r0 = reciprocal(d0);
  const float l1 = at.xy * r0;
  const float l2 = at.xt * r0;
  const float d1 = at.yy * grow - l1 * at.xy;
  if (!(d1 > kLeastPivot)) return false;
  const float r1 = reciprocal(d1);
  const float rest = at.yt - l2 * at.xy;
  const float l3 = rest * r1;
  const float d2 = (at.tt * grow - l2 * at.xt) - l3 * rest;
  if (!(d2 > kLeastPivot)) return false;
  const float u0 = -at.x;
  const float u1 = -at.y - l1 * u0;
  const float u2 = (-at.theta - l2 * u0) - l3 * u1;
  step.theta = u2 * reciprocal(d2);
  step.y = u1 * r1 - l3 * step.theta;
  step.x = (u0 * r0 - l1 * step.y) - l2 * step.theta;
  return true;
}

/// One descent; it counts its evaluations.
class SlopeWalk {
 public:
  SlopeWalk(const PoseDescent::Params& params, const std::uint16_t* field, const PointCells* points)
      : params_(params), field_(field), points_(points) {}

  void run(PolishedPose& result) {
    pose_ = {result.x, result.y, result.theta};
    enter(params_.width);
    while (stop_ == 0) {
      DescentPose step;
      const bool is_regular = damped_step(here_, damping_, step);
      if (damping_ > kMostDamping || (is_regular && is_small(step))) {
        leave();
      } else if (!is_regular) {
        damping_ = more_damping(damping_);
      } else if (may_evaluate()) {
        try_step(step);
      }
    }
    const float cost = here_.cost < kMostCost ? here_.cost : kMostCost;
    result.x = pose_.x;
    result.y = pose_.y;
    result.theta = pose_.theta;
    result.cost = static_cast<std::uint32_t>(static_cast<std::int32_t>(cost));
    result.evaluations += evaluations_;
    result.stop = stop_;
  }

 private:
  [[nodiscard]] bool is_last() const { return !(gate_.width > params_.last_width); }

  bool is_small(const DescentPose& step) const {
    const float loose = is_last() ? 1.0F : PoseDescent::kLoose;
    return __builtin_fabsf(step.x) < loose * params_.stop_cells && __builtin_fabsf(step.y) < loose * params_.stop_cells &&
           __builtin_fabsf(step.theta) < loose * params_.stop_rad;
  }

  bool may_evaluate() {
    if (evaluations_ >= params_.max_evaluations) stop_ = 2;
    return stop_ == 0;
  }

  PoseSlope evaluate(const DescentPose& pose) {
    ++evaluations_;
    return slope_at(params_, field_, points_, gate_, pose);
  }

  void enter(float width) {
    gate_ = gate_width(width > params_.last_width ? width : params_.last_width);
    damping_ = kFirstDamping;
    here_ = evaluate(pose_);
  }

  /// A width is done.
  void leave() {
    if (is_last()) {
      stop_ = 1;
    } else if (may_evaluate()) {
      enter(gate_.width * params_.narrowing);
    }
  }

  void try_step(const DescentPose& step) {
    const DescentPose next{pose_.x + step.x, pose_.y + step.y, pose_.theta + step.theta};
    const PoseSlope there = evaluate(next);
    if (there.cost < here_.cost) {
      pose_ = next;
      here_ = there;
    } else {
      damping_ = more_damping(damping_);
    }
  }

  const PoseDescent::Params& params_;
  const std::uint16_t* field_;
  const PointCells* points_;
  DescentPose pose_{};
  PoseSlope here_{};
  GateWidth gate_{};
  float damping_ = kFirstDamping;
  std::uint32_t evaluations_ = 0;
  std::uint32_t stop_ = 0;
};

void pose_descent(const PoseDescent::Params& params, const std::uint16_t* field, const PointCells* points,
                  PolishedPose* poses, std::uint16_t* values, Slice slice) {
  const std::uint32_t count = params.grid.point_count;
  const std::uint32_t row = PoseDescent::row_of(count);
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    SlopeWalk(params, field, points).run(poses[i]);
    std::uint16_t* const under = values + at(row, i);
    point_values(params.grid, field, points, {poses[i].x, poses[i].y, poses[i].theta}, under);
    if (row > count) under[count] = 0;
  }
}
