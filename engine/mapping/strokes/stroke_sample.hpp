// The points of the current stroke of the mount, or a sample of them: points in log order are cut where the elevation
// turns back. One object belongs to one thread. Memory: the sample.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

/// One movement of the mount from end to end.
struct Stroke {
  std::uint32_t first_scan = 0;
  bool is_upward = true;
};

class StrokeSample {
 public:
  /// Of more than `most_points` every second, fourth... is kept.
  explicit StrokeSample(std::size_t most_points) : most_points_(most_points) {}

  /// True if the next point begins another stroke: take_stroke() must be called before it is added.
  [[nodiscard]] bool ends_before(const CloudPoint& point) const {
    if (!scan_ || *scan_ == point.scan || direction_ == 0) return false;
    const float step = point.elevation_rad - turning_rad_;
    return step * static_cast<float>(direction_) < 0.0F && std::fabs(step) > kTurnedBack_rad;
  }
  void add(const CloudPoint& point) {
    if (!scan_ || *scan_ != point.scan) begin_scan(point);
    if (seen_++ % every_ != 0) return;
    if (points_.size() == most_points_) halve();
    points_.push_back(point);
  }
  [[nodiscard]] bool is_empty() const { return points_.empty(); }
  /// The stroke so far and its points; the next one goes the other way.
  std::pair<Stroke, Cloud> take_stroke() {
    const Stroke stroke{first_scan_, direction_ >= 0};
    direction_ = -direction_;
    is_new_ = true;
    every_ = 1;
    seen_ = 0;
    return {stroke, std::exchange(points_, {})};
  }

 private:
  /// A stroke has ended when the elevation is this far behind its furthest.
  static constexpr float kTurnedBack_rad = 0.05F;

  void begin_scan(const CloudPoint& point) {
    scan_ = point.scan;
    if (is_new_) first_scan_ = point.scan;
    if (is_new_) turning_rad_ = point.elevation_rad;
    is_new_ = false;
    const float step = point.elevation_rad - turning_rad_;
    if (direction_ == 0 && std::fabs(step) > kTurnedBack_rad) direction_ = step > 0.0F ? 1 : -1;
    if (step * static_cast<float>(direction_) > 0.0F) turning_rad_ = point.elevation_rad;
  }
  void halve() {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < points_.size(); k += 2) points_[kept++] = points_[k];
    points_.resize(kept);
    every_ *= 2;
  }

  std::size_t most_points_;
  Cloud points_;
  std::uint64_t every_ = 1;
  std::uint64_t seen_ = 0;
  std::optional<std::uint32_t> scan_;
  std::uint32_t first_scan_ = 0;
  bool is_new_ = true;
  float turning_rad_ = 0.0F;  // elevation of the farthest scan of this stroke
  int direction_ = 0;         // 1 upwards, -1 downwards, 0 until it is known
};

}  // namespace gdtslam
