#include "sweep_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "stopwatch.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastWeakest = 1.0e-2;  // least ratio of smallest to largest singular value for a reliable correction
constexpr double kCell_m = 0.08;          // sweeps are compared by the means of their points in such cubes
constexpr std::uint32_t kMostPoints = 1500;
constexpr double kMostNoise = 3.0;  // allowed distance of sweeps in standard deviations of the surfaces' noise

Point3 find_centre(const Cloud& cloud) {
  Point3 sum = Point3::Zero();
  for (const CloudPoint& point : cloud) {
    sum += Point3(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m));
  }
  return sum / static_cast<double>(cloud.size());
}

// Root mean square over the points.
double moved_m(const Pose3& T, const Cloud& cloud) {
  double sq_sum = 0.0;
  for (const CloudPoint& point : cloud) {
    const Point3 place(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m));
    sq_sum += (T * place - place).squaredNorm();
  }
  return std::sqrt(sq_sum / static_cast<double>(cloud.size()));
}

}  // namespace

// Every n-th point, n doubled when the sample is full.
void SweepSampler::add(std::span<const CloudPoint> points) {
  if (!config_.is_on) return;
  for (const CloudPoint& point : points) {
    if (!has_scan_ || point.scan != scan_) {
      if (stroke_ends_.take(point.elevation_rad)) close_sweep();
      has_scan_ = true;
      scan_ = point.scan;
    }
    if (seen_++ % every_ != 0) continue;
    if (current_.size() == config_.max_points) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < current_.size(); k += 2) current_[kept++] = current_[k];
      current_.resize(kept);
      every_ *= 2;
    }
    current_.push_back(point);
  }
}

void SweepSampler::close_sweep() {
  Stopwatch watch;
  const bool is_large = current_.size() >= config_.min_points;
  Cloud means = is_large ? means_of_cubes(current_, kCell_m) : Cloud();
  if (is_large && is_previous_large_) {
    RegistrationOptions options;
    options.max_points = kMostPoints;
    const RegistrationResult found = register_clouds(means, previous_means_, options);
    if (found.converged && found.weakest_share >= kLeastWeakest) {
      // The shift is taken at the sweep's centre: at the map's origin a turn would count as a shift.
      const Point3 centre = find_centre(current_);
      const Point3 shift = found.T_target_source * centre - centre;
      const Eigen::Vector3d turn = log_so3(found.T_target_source.rotation);
      const double shift_m = shift.norm();
      const double turn_rad = turn.norm();
      ++outcome_.pairs;
      outcome_.mean_shift_m += shift_m;
      outcome_.mean_turn_rad += turn_rad;
      outcome_.mean_rms_m += found.rms_m;
      outcome_.mean_moved_m += moved_m(found.T_target_source, current_);
      outcome_.max_shift_m = std::max(outcome_.max_shift_m, shift_m);
      outcome_.max_turn_rad = std::max(outcome_.max_turn_rad, turn_rad);
      drift_m_ += shift;
      drift_rad_ += turn;
    } else {
      ++outcome_.not_held;
      if (!found.converged && found.weakest_share >= kLeastWeakest) ++outcome_.apart;
    }
  }
  previous_means_ = std::move(means);
  is_previous_large_ = is_large;
  current_.clear();
  every_ = 1;
  seen_ = 0;
  watch.add_to(outcome_.wall_s);
}

SweepCheck SweepSampler::finish() {
  if (!current_.empty()) close_sweep();
  if (outcome_.pairs > 0) {
    const auto pairs = static_cast<double>(outcome_.pairs);
    outcome_.mean_shift_m /= pairs;
    outcome_.mean_turn_rad /= pairs;
    outcome_.mean_rms_m /= pairs;
    outcome_.mean_moved_m /= pairs;
    outcome_.drift_m = drift_m_.norm();
    outcome_.drift_rad = drift_rad_.norm();
  }
  return outcome_;
}

std::string SweepCheck::doubt() const {
  const std::string advice = "check --linkage, or calibrate the mount (gdtslam calibrate)";
  if (2 * apart > pairs + not_held) {
    return fmt::format("{} of {} sweeps fit the one before with no correction; {}", apart, pairs + not_held, advice);
  }
  if (pairs == 0 || mean_moved_m <= kMostNoise * mean_rms_m) return {};
  return fmt::format(
      "points of one sweep lie {:.0f} mm from those of the sweep before, {:.1f} times the noise of its "
      "surfaces; {}",
      1000.0 * mean_moved_m, mean_moved_m / mean_rms_m, advice);
}

}  // namespace gdtslam
