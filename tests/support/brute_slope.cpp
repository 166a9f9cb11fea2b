#include "brute_slope.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "single.hpp"

namespace gdtslam::test {
namespace {

using Three = std::array<Single, 3>;  // along x, y, theta
using Lanes = std::array<Single, 64>;

/// The cost of a pose and its normal equations; the curvature's upper triangle only.
struct Equations {
  Single cost;
  Three gradient;
  std::array<Three, 3> curvature;
};

Single cell_value(const PoseCost::Params& grid, const std::vector<std::uint16_t>& field, std::size_t x, std::size_t y) {
  const std::size_t place = x / 64 * grid.strip + x % 64 + y * grid.stride;
  return {static_cast<float>(field[place] ^ grid.blank)};
}

/// The field at a place, with its slopes along x and y.
struct FieldSlope {
  Single value;
  Single x;
  Single y;
};

/// Between the centres of four cells; (u, v) is the place less half a cell.
FieldSlope field_slope(const PoseCost::Params& grid, const std::vector<std::uint16_t>& field, Single u, Single v) {
  const FieldSlope none{{static_cast<float>(grid.cap)}, {}, {}};
  const Single column = Single{std::floor(u.value)} + Single{static_cast<float>(grid.anchor_x)};
  const Single row = Single{std::floor(v.value)} + Single{static_cast<float>(grid.anchor_y)};
  const auto is_inside = [](Single at, std::uint32_t size) {
    return at.value >= 0.0F && at.value <= static_cast<float>(size - 2);
  };
  if (!is_inside(column, grid.width) || !is_inside(row, grid.height)) return none;
  const auto x = static_cast<std::size_t>(column.value);
  const auto y = static_cast<std::size_t>(row.value);
  const Single fx = u - Single{std::floor(u.value)};
  const Single fy = v - Single{std::floor(v.value)};
  const Single v00 = cell_value(grid, field, x, y);
  const Single v10 = cell_value(grid, field, x + 1, y);
  const Single v01 = cell_value(grid, field, x, y + 1);
  const Single v11 = cell_value(grid, field, x + 1, y + 1);
  const Single bottom = v00 + fx * (v10 - v00);
  const Single top = v01 + fx * (v11 - v01);
  const Single left = v00 + fy * (v01 - v00);
  const Single right = v10 + fy * (v11 - v10);
  const Single value = bottom + fy * (top - bottom);
  return value.value < none.value.value ? FieldSlope{value, right - left, top - bottom} : none;
}

void add_prior(const PriorParams& prior, const Three& pose, Equations& sums) {
  const Three off{pose[0] - Single{prior.mean_x}, pose[1] - Single{prior.mean_y}, pose[2] - Single{prior.mean_theta}};
  const Single shift = (off[0] * off[0] + off[1] * off[1]) * Single{prior.weight_xy};
  const Single turn = (off[2] * off[2]) * Single{prior.weight_theta};
  const auto limited = [&](Single cost) { return cost.value < prior.limit ? cost : Single{prior.limit}; };
  sums.cost = sums.cost + (limited(shift) + limited(turn));
  for (std::size_t i = 0; i < 3; ++i) {
    const bool pulls = (i < 2 ? shift : turn).value < prior.limit;
    const Single weight = Single{pulls ? 2.0F : 0.0F} * Single{i < 2 ? prior.weight_xy : prior.weight_theta};
    sums.gradient[i] = sums.gradient[i] + weight * off[i];
    sums.curvature[i][i] = sums.curvature[i][i] + weight;
  }
}

/// Solves (H + damping diag(H)) step = -gradient by LDL^T; false if a pivot is too small.
bool solve(const Equations& sums, Single damping, Three& step) {
  std::array<Three, 3> l{};      // unit lower triangle
  std::array<Three, 3> above{};  // l times the pivots
  Three per_pivot;
  Three u;
  for (std::size_t i = 0; i < 3; ++i) {
    Single pivot = sums.curvature[i][i] * (Single{1.0F} + damping);
    u[i] = Single{-sums.gradient[i].value};
    for (std::size_t j = 0; j < i; ++j) {
      above[i][j] = sums.curvature[j][i];
      for (std::size_t k = 0; k < j; ++k) above[i][j] = above[i][j] - l[i][k] * above[j][k];
      l[i][j] = above[i][j] * per_pivot[j];
      pivot = pivot - l[i][j] * above[i][j];
      u[i] = u[i] - l[i][j] * u[j];
    }
    if (!(pivot.value > 1.0e-20F)) return false;
    per_pivot[i] = reciprocal(pivot);
  }
  for (const std::size_t i : {2U, 1U, 0U}) {
    step[i] = u[i] * per_pivot[i];
    for (std::size_t k = i + 1; k < 3; ++k) step[i] = step[i] - l[k][i] * step[k];
  }
  return true;
}

class SlopeDescent {
 public:
  SlopeDescent(const PoseDescent::Params& params, const std::vector<std::uint16_t>& field,
               const std::vector<PointCells>& points)
      : params_(params), field_(field), points_(points) {}

  PolishedPose from(const PolishedPose& start) {
    pose_ = {Single{start.x}, Single{start.y}, Single{start.theta}};
    PolishedPose end = start;
    end.stop = walk();
    end.x = pose_[0].value;
    end.y = pose_[1].value;
    end.theta = pose_[2].value;
    end.cost = static_cast<std::uint32_t>(here_.cost.value < 2.0e9F ? here_.cost.value : 2.0e9F);
    end.evaluations = static_cast<std::uint32_t>((std::uint64_t{start.evaluations} + calls_) % (1ULL << 32U));
    return end;
  }

 private:
  Equations equations_at(const Three& pose) {
    ++calls_;
    const Single per_width = reciprocal(width_);
    const Single most = (width_ * width_) * Single{1.0F / (6.0F * 256.0F)};
    const SinCos<float> rotation = sin_cos(pose[2].value);
    const Single s{rotation.sin};
    const Single c{rotation.cos};
    Lanes cost{};
    std::array<Lanes, 3> gradient{};
    std::array<std::array<Lanes, 3>, 3> curvature{};
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const std::size_t lane = p % 64;
      const Single x = c * Single{points_[p].x} - s * Single{points_[p].y};
      const Single y = s * Single{points_[p].x} + c * Single{points_[p].y};
      const Single half{0.5F};
      const FieldSlope at = field_slope(params_.grid, field_, (x + pose[0]) - half, (y + pose[1]) - half);
      const Three g{at.x, at.y, at.y * x - at.x * y};
      const Single share = at.value * per_width;
      const Single t{share.value < 1.0F ? share.value : 1.0F};
      const Single q = Single{1.0F} - t * t;
      const Single weight = (q * q) * Single{1.0F / 256.0F};
      cost[lane] = cost[lane] + most * (Single{1.0F} - (q * q) * q);
      for (std::size_t i = 0; i < 3; ++i) {
        gradient[i][lane] = gradient[i][lane] + (weight * at.value) * g[i];
        for (std::size_t j = i; j < 3; ++j) curvature[i][j][lane] = curvature[i][j][lane] + (weight * g[i]) * g[j];
      }
    }
    Equations sums{.cost = sum_of(cost), .gradient = {}, .curvature = {}};
    for (std::size_t i = 0; i < 3; ++i) {
      sums.gradient[i] = sum_of(gradient[i]);
      for (std::size_t j = i; j < 3; ++j) sums.curvature[i][j] = sum_of(curvature[i][j]);
    }
    add_prior(params_.prior, pose, sums);
    return sums;
  }

  [[nodiscard]] bool is_small(const Three& step) const {
    const Single loose{width_.value > params_.last_width ? 8.0F : 1.0F};
    const float cells = (loose * Single{params_.stop_cells}).value;
    return std::fabs(step[0].value) < cells && std::fabs(step[1].value) < cells &&
           std::fabs(step[2].value) < (loose * Single{params_.stop_rad}).value;
  }

  [[nodiscard]] bool is_at_limit() const { return calls_ >= params_.max_evaluations; }

  /// All widths; returns the reason for stopping.
  std::uint32_t walk() {
    width_.value = std::max(params_.width, params_.last_width);
    for (;;) {
      here_ = equations_at(pose_);
      if (!walk_at_width()) return 2;
      if (!(width_.value > params_.last_width)) return 1;
      if (is_at_limit()) return 2;
      width_.value = std::max((width_ * Single{params_.narrowing}).value, params_.last_width);
    }
  }

  /// False if the limit was reached first.
  bool walk_at_width() {
    for (Single damping{1.0e-4F}; damping.value <= 1000.0F;) {
      Three step;
      if (solve(here_, damping, step)) {
        if (is_small(step)) return true;
        if (is_at_limit()) return false;
        const Three next{pose_[0] + step[0], pose_[1] + step[1], pose_[2] + step[2]};
        const Equations there = equations_at(next);
        if (there.cost.value < here_.cost.value) {
          pose_ = next;
          here_ = there;
          continue;
        }
      }
      damping = damping.value < 1.0F ? Single{1.0F} : Single{4.0F} * damping;
    }
    return true;
  }

  const PoseDescent::Params& params_;
  const std::vector<std::uint16_t>& field_;
  const std::vector<PointCells>& points_;
  Three pose_{};
  Equations here_{};
  Single width_;
  std::uint64_t calls_ = 0;
};

}  // namespace

PolishedPose brute_slope_descent(const PoseDescent::Params& params, const std::vector<std::uint16_t>& field,
                                 const std::vector<PointCells>& points, const PolishedPose& start) {
  return SlopeDescent(params, field, points).from(start);
}

}  // namespace gdtslam::test
