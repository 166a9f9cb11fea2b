// Pairs of a point of one stroke and the plane through its neighbours in the next. O(points log points).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gdtslam/core/pose3.hpp"

namespace gdtslam::calib {

struct StrokePair {
  static constexpr std::size_t kNeighbours = 10;
  std::uint32_t point = 0;
  std::array<std::uint32_t, kNeighbours> plane{};  ///< points that the plane goes through
  Point3 normal{0.0, 0.0, 1.0};
};

/// For at most `most` points, spread evenly, those that have a flat neighbourhood within `gate_m` in the next stroke.
std::vector<StrokePair> stroke_pairs(const std::vector<Point3>& points, const std::vector<std::uint32_t>& strokes,
                                     double gate_m, std::uint32_t most);
/// Of the point over the plane through the neighbours, along its normal, the sign being that of the pair's: when the
/// model turns all points alike, the plane turns with them and the miss stays.
double miss_m(const StrokePair& pair, const std::vector<Point3>& points);

}  // namespace gdtslam::calib
