// Compares consecutive sweeps of the mount. The points of each sweep are registered to those of the previous one, point
// to plane. If poses and linkage are right, the correction is zero; the corrections found are reported. Memory: a
// sample of two sweeps.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/registration.hpp"
#include "engine/mapping/strokes/stroke_sample.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

struct SweepCheckConfig {
  bool is_on = true;
  std::uint32_t max_points = 20000;  ///< points sampled from a sweep
  std::uint32_t min_points = 500;    ///< a sweep with fewer is not compared
};

/// Collects a sample of each sweep from the points in log order; a sweep ends when the elevation reverses.
class SweepSampler {
 public:
  explicit SweepSampler(const SweepCheckConfig& config) : config_(config), sample_(config.max_points) {}
  void add(std::span<const CloudPoint> points);
  /// Registers the last sweep and returns the outcome.
  SweepCheck finish();

 private:
  void close_sweep();

  SweepCheckConfig config_;
  StrokeSample sample_;
  Cloud previous_means_;            ///< means per cube of the previous sweep
  bool is_previous_large_ = false;  ///< the previous sweep has enough points for a comparison
  Point3 drift_m_ = Point3::Zero();
  Eigen::Vector3d drift_rad_ = Eigen::Vector3d::Zero();
  SweepCheck outcome_;
};

}  // namespace gdtslam
