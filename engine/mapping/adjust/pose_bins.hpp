// Poses in square bins of the plane, for a fast search near a position. Not thread-safe while poses are added. Cost:
// constant for each pose, and for each that is near.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

inline double squared_distance(const Pose2& a, const Pose2& b) {
  const double dx = a.x_m - b.x_m;
  const double dy = a.y_m - b.y_m;
  return dx * dx + dy * dy;
}

class PoseBins {
 public:
  /// Bins of this size; poses farther away than that may be missed.
  explicit PoseBins(double size_m) : size_m_(size_m) {}
  void add(std::size_t index, const Pose2& pose) { bins_[key(bin(pose.x_m), bin(pose.y_m))].push_back(index); }
  template <class Visit>
  void visit_near(const Pose2& pose, const Visit& visit) const {
    for (std::int64_t y = bin(pose.y_m) - 1; y <= bin(pose.y_m) + 1; ++y) {
      for (std::int64_t x = bin(pose.x_m) - 1; x <= bin(pose.x_m) + 1; ++x) {
        const auto found = bins_.find(key(x, y));
        if (found == bins_.end()) continue;
        for (const std::size_t index : found->second) visit(index);
      }
    }
  }

 private:
  [[nodiscard]] std::int64_t bin(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / size_m_));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
  }

  double size_m_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> bins_;  // never iterated over
};

}  // namespace gdtslam
