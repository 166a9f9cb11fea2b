// Cubes of space by a number, to sort points into them. Thread-safe, constant time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// Index of a cube along x, y and z; cube 0 begins at the origin.
using Cell = std::array<std::int64_t, 3>;

/// The cube around a point; of one farther than 2^20 cubes along an axis the outermost. The point must be finite.
inline Cell cell_around(const Point3& point, double edge_m) {
  constexpr double kFarthest = 0x100000;
  const auto index = [edge_m](double coordinate_m) {
    return static_cast<std::int64_t>(std::clamp(std::floor(coordinate_m / edge_m), -kFarthest, kFarthest - 1.0));
  };
  return {index(point.x()), index(point.y()), index(point.z())};
}

/// A number for each cube that cell_around() gives.
inline std::uint64_t key_of(const Cell& cell) {
  const auto bits = [](std::int64_t index) { return static_cast<std::uint64_t>(index + 0x100000) & 0x1fffffU; };
  return bits(cell[0]) << 42U | bits(cell[1]) << 21U | bits(cell[2]);
}

}  // namespace gdtslam
