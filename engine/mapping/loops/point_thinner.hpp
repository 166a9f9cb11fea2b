// The first point of each cell, in the order in which they come. Not thread-safe; constant time each.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class PointThinner {
 public:
  explicit PointThinner(double spacing_m) : spacing_m_(spacing_m) {}
  bool is_first(const Point2& point) {
    const auto x = static_cast<std::int32_t>(std::floor(point.x() / spacing_m_));
    const auto y = static_cast<std::int32_t>(std::floor(point.y() / spacing_m_));
    return seen_
        .insert((static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y))
        .second;
  }

 private:
  double spacing_m_;
  std::unordered_set<std::uint64_t> seen_;  // never iterated over
};

}  // namespace gdtslam
