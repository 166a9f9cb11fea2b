// Nearest points of a cloud, by nanoflann's k-d tree. Ties go by the tree's order, which depends on the points alone.
// Building: O(n log n); a question: O(log n). Questions are thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

class Neighbours {
 public:
  explicit Neighbours(std::span<const CloudPoint> cloud);
  ~Neighbours();
  /// Nothing when none lies within the distance.
  [[nodiscard]] std::optional<std::uint32_t> nearest(const Point3& point, double within_m) const;
  /// The `count` closest points, closest first; fewer where the cloud has fewer.
  [[nodiscard]] std::vector<std::uint32_t> closest(const Point3& point, std::uint32_t count) const;
  /// All points within the distance, ascending.
  [[nodiscard]] std::vector<std::uint32_t> within(const Point3& point, double distance_m) const;
  [[nodiscard]] Point3 point(std::uint32_t k) const;
  /// The normal of the plane through point k and the `count` points closest to it; nothing where they are fewer than
  /// five, or as thick as `flat` times their lesser extent along it.
  [[nodiscard]] std::optional<Point3> normal(std::uint32_t k, std::uint32_t count, double flat) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace gdtslam
