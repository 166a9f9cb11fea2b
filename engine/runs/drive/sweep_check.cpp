#include "sweep_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/to_position.hpp"
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
    sum += to_position(point);
  }
  return sum / static_cast<double>(cloud.size());
}

// Root mean square over the points.
double moved_m(const Pose3& T, const Cloud& cloud) {
  double sq_sum = 0.0;
  for (const CloudPoint& point : cloud) {
    const Point3 place = to_position(point);
    sq_sum += (T * place - place).squaredNorm();
  }
  return std::sqrt(sq_sum / static_cast<double>(cloud.size()));
}

}  // namespace

void SweepSampler::add(std::span<const CloudPoint> points) {
  if (!config_.is_on) return;
  for (const CloudPoint& point : points) {
    if (sample_.ends_before(point)) close_sweep();
    sample_.add(point);
  }
}

void SweepSampler::close_sweep() {
  Stopwatch watch;
  const Cloud current = sample_.take_stroke().second;
  const bool is_large = current.size() >= config_.min_points;
  Cloud means = is_large ? means_of_cubes(current, kCell_m) : Cloud();
  if (is_large && is_previous_large_) {
    RegistrationOptions options;
    options.max_points = kMostPoints;
    const RegistrationResult found = register_clouds(means, previous_means_, options);
    if (found.converged && found.weakest_share >= kLeastWeakest) {
      // The shift is taken at the sweep's centre: at the map's origin a turn would count as a shift.
      const Point3 centre = find_centre(current);
      const Point3 shift = found.T_target_source * centre - centre;
      const Eigen::Vector3d turn = log_so3(found.T_target_source.rotation);
      const double shift_m = shift.norm();
      const double turn_rad = turn.norm();
      ++outcome_.pairs;
      outcome_.mean_shift_m += shift_m;
      outcome_.mean_turn_rad += turn_rad;
      outcome_.mean_rms_m += found.rms_m;
      outcome_.mean_moved_m += moved_m(found.T_target_source, current);
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
  watch.add_to(outcome_.wall_s);
}

SweepCheck SweepSampler::finish() {
  if (!sample_.is_empty()) close_sweep();
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
