// A cloud packed for a page: 12 bytes a point, little-endian: x, y, z and time in 16 bits, elevation, scan, distance in
// 8, each as a share of its range, and which level surface the point lies on. Thread-safe; O(points).
//
// Point k of the page is point (k * step) mod n of the n kept ones, step being coprime to n and near n / golden ratio:
// every beginning of the page's points is spread evenly over the log, which is what a slow machine draws while the
// camera moves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/drawing/page/page_writer.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam::page {

inline constexpr std::size_t kBytesPerPoint = 12;
inline constexpr std::size_t kPointsPerElement = std::size_t{1} << 18U;
/// 256 MB of page; browsers hold no text beyond 512 MB.
inline constexpr std::size_t kMostPoints = std::size_t{16} << 20U;

/// What a point has, over all points that are kept.
struct Range {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  double low = 0.0;   ///< 1st percentile of those that are no part of the ceiling
  double high = 0.0;  ///< 99th
  [[nodiscard]] double extent() const { return most - least; }
};

/// Floor and below, ceiling and above, with the margins of pictures of clouds: lamps go with the ceiling.
enum class LevelCode : std::uint8_t { kNone, kFloor, kCeiling };

class PagedCloud {
 public:
  /// Throws InputError for a cloud of which no point is finite, has more than kMostPoints or other distances than
  /// points.
  PagedCloud(const Cloud& cloud, const std::vector<float>* distances_m);
  [[nodiscard]] Json description() const;
  void add_points(PageData& page) const;
  [[nodiscard]] std::size_t elements() const { return (kept_.size() + kPointsPerElement - 1) / kPointsPerElement; }
  [[nodiscard]] const Point3& least() const { return least_; }

 private:
  void keep_points();
  void measure();
  void find_levels();
  [[nodiscard]] LevelCode level_of(const CloudPoint& point) const;
  template <class ValueOf>
  [[nodiscard]] Range range_of(const ValueOf& value_of) const;
  void append_point(std::size_t index, ByteWriter& bytes) const;

  const Cloud& cloud_;
  const std::vector<float>* distances_m_;
  std::vector<std::uint32_t> kept_;  ///< indices into the cloud
  std::uint64_t step_ = 1;
  Point3 least_{0.0, 0.0, 0.0};
  Point3 most_{0.0, 0.0, 0.0};
  Point3 middle_least_{0.0, 0.0, 0.0};  ///< of the middle 99.8 %, for the camera
  Point3 middle_most_{0.0, 0.0, 0.0};
  Range height_;
  Range time_;
  Range elevation_;
  Range scan_;
  Range distance_;
  std::optional<Plane> floor_;
  std::optional<Plane> ceiling_;
  std::uint64_t floor_points_ = 0;
  std::uint64_t ceiling_points_ = 0;
};

}  // namespace gdtslam::page
