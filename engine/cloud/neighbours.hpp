// Nearest points of a cloud, by nanoflann's k-d tree. Ties go by the tree's order, which depends on the points alone.
// Building: O(n log n); a query: O(log n). Queries are thread-safe.
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
  /// Nearest point; empty if none lies within the distance.
  [[nodiscard]] std::optional<std::uint32_t> nearest(const Point3& point, double within_m) const;
  /// The `count` closest points, closest first; fewer if the cloud has fewer.
  [[nodiscard]] std::vector<std::uint32_t> closest(const Point3& point, std::uint32_t count) const;
  /// All points within the distance, ascending.
  [[nodiscard]] std::vector<std::uint32_t> within(const Point3& point, double distance_m) const;
  [[nodiscard]] Point3 point(std::uint32_t k) const;
  /// The least-squares plane of some points: their mean, and the unit normal, of either sign.
  struct Patch {
    Point3 mean = Point3::Zero();
    Point3 normal = Point3::Zero();
    [[nodiscard]] double distance_m(const Point3& at) const { return normal.dot(at - mean); }
  };
  /// The patch of the `count` points closest to point k, including itself. Empty for fewer than five, or if their
  /// extent along the normal is not below `flat` times the lesser of the other two.
  [[nodiscard]] std::optional<Patch> patch(std::uint32_t k, std::uint32_t count, double flat) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace gdtslam
