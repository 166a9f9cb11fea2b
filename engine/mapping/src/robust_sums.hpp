// The field with its slope under a point, and the sums of the normal equations over the points of a scan. Constant time
// for each point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "gdtslam/compute/kernels/pose_cost.hpp"
#include "gdtslam/mapping/objective.hpp"

namespace gdtslam {

/// A field in 1/256 cell, bilinear between the centres of its cells; coordinates in cells relative to the anchor.
class FieldSlope {
 public:
  FieldSlope(const PoseCost::Params& grid, const std::uint16_t* cells) : grid_(grid), cells_(cells) {}

  struct Value {
    float value = 0.0F;    ///< 1/256 cell, at most the cap
    float slope_x = 0.0F;  ///< 1/256 cell a cell; zero at the cap
    float slope_y = 0.0F;
  };
  [[nodiscard]] Value at(float x, float y) const {
    const Place column = place_of(x, grid_.anchor_x, grid_.width);
    const Place row = place_of(y, grid_.anchor_y, grid_.height);
    const std::uint16_t* const low = cells_ + std::size_t{row.cell} * grid_.stride + column.cell;
    const std::uint16_t* const high = low + grid_.stride;
    const auto v00 = static_cast<float>(low[0]);
    const auto v10 = static_cast<float>(low[1]);
    const auto v01 = static_cast<float>(high[0]);
    const auto v11 = static_cast<float>(high[1]);
    const float bottom = v00 + column.fraction * (v10 - v00);
    const float top = v01 + column.fraction * (v11 - v01);
    const float left = v00 + row.fraction * (v01 - v00);
    const float right = v10 + row.fraction * (v11 - v10);
    const float value = bottom + row.fraction * (top - bottom);
    const auto cap = static_cast<float>(grid_.cap);
    if (!(value < cap)) return {cap, 0.0F, 0.0F};
    return {value, right - left, top - bottom};
  }

 private:
  struct Place {
    std::uint32_t cell = 0;
    float fraction = 0.0F;
  };
  // The two outermost rows and columns hold the cap, so a point off the map reads it at the nearest of them.
  static Place place_of(float position, std::int32_t anchor, std::uint32_t size) {
    const float centred = position - 0.5F;
    const float cell = std::floor(centred);
    const float wanted = cell + static_cast<float>(anchor);
    const float last = static_cast<float>(size - 2);
    const float held = wanted > 0.0F ? std::min(wanted, last) : 0.0F;
    return {static_cast<std::uint32_t>(held), held == wanted ? centred - cell : 0.0F};
  }

  PoseCost::Params grid_;
  const std::uint16_t* cells_;
};

class RobustSums {
 public:
  static constexpr std::size_t kLanes = 8;

  /// A point's field value with its slopes along x, y and theta.
  void add(std::size_t lane, const FieldSlope::Value& at, float slope_theta, float scale) {
    const float weight = 1.0F / std::max(at.value, scale);
    const float pull = weight * at.value;
    const float wx = weight * at.slope_x;
    const float wy = weight * at.slope_y;
    const float wt = weight * slope_theta;
    const std::array<float, kSums> terms{at.value < scale ? 0.5F * at.value * pull : at.value - 0.5F * scale,
                                         pull * at.slope_x,
                                         pull * at.slope_y,
                                         pull * slope_theta,
                                         wx * at.slope_x,
                                         wx * at.slope_y,
                                         wx * slope_theta,
                                         wy * at.slope_y,
                                         wy * slope_theta,
                                         wt * slope_theta};
    for (std::size_t k = 0; k < kSums; ++k) lanes_[k][lane] += terms[k];
  }

  [[nodiscard]] Linearisation total() const {
    std::array<double, kSums> sums{};
    for (std::size_t k = 0; k < kSums; ++k) {
      for (const float lane : lanes_[k]) sums[k] += static_cast<double>(lane);
    }
    Linearisation result;
    result.cost = sums[0];
    std::copy_n(sums.begin() + 1, 3, result.gradient.begin());
    std::copy_n(sums.begin() + 4, 6, result.curvature.begin());
    return result;
  }

 private:
  static constexpr std::size_t kSums = 10;
  std::array<std::array<float, kLanes>, kSums> lanes_{};
};

}  // namespace gdtslam
