#include "engine/mapping/surface/wall_direction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/core/elementary.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kDirectionBins = 900;  // bins of a quarter turn
constexpr std::size_t kWindowBins = 20;      // on each side: 2 degrees
constexpr int kRefinements = 20;
constexpr double kLeastShare = 0.15;
constexpr double kQuarter_rad = 0.5 * kPi;
constexpr double kBin_rad = kQuarter_rad / static_cast<double>(kDirectionBins);
constexpr double kWindow_rad = kBin_rad * static_cast<double>(kWindowBins);

// Folds an angle into [0, a quarter turn).
double in_quarter(double angle_rad) {
  const double folded = angle_rad - kQuarter_rad * std::floor(angle_rad / kQuarter_rad);
  return folded < kQuarter_rad ? folded : 0.0;
}

// The shortest turn from one direction to another.
double turn_between(double from_rad, double to_rad) {
  return in_quarter(to_rad - from_rad + 0.5 * kQuarter_rad) - 0.5 * kQuarter_rad;
}

double middle_of_bin(std::size_t bin) { return (static_cast<double>(bin) + 0.5) * kBin_rad; }

}  // namespace

WallDirectionFinder::WallDirectionFinder() : weight_(kDirectionBins, 0.0), sum_(kDirectionBins, 0.0) {}

void WallDirectionFinder::add(const std::vector<Point2>& points_base_m, const Pose2& T_map_base) {
  for (const SurfacePoint& p : keep_scan(points_base_m).surface) {
    const double normal_rad = atan2(static_cast<double>(p.normal_y), static_cast<double>(p.normal_x));
    const double angle_rad = in_quarter(normal_rad + T_map_base.theta_rad);
    const std::size_t bin = std::min(static_cast<std::size_t>(angle_rad / kBin_rad), kDirectionBins - 1);
    const double x = p.x_m;
    const double y = p.y_m;
    const double length_m = std::sqrt(x * x + y * y);
    weight_[bin] += length_m;
    sum_[bin] += length_m * (angle_rad - middle_of_bin(bin));
  }
}

std::optional<WallDirection> WallDirectionFinder::direction() const {
  double all = 0.0;
  for (const double weight : weight_) all += weight;
  std::size_t best = 0;
  double most = 0.0;
  for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
    double around = 0.0;
    for (std::size_t k = 0; k <= 2 * kWindowBins; ++k) {
      const double flank = static_cast<double>(k > kWindowBins ? k - kWindowBins : kWindowBins - k);
      around += weight_[(bin + kDirectionBins + k - kWindowBins) % kDirectionBins] *
                (1.0 - flank / static_cast<double>(kWindowBins + 1));
    }
    if (around <= most) continue;
    most = around;
    best = bin;
  }
  if (!(all > 0.0)) return std::nullopt;
  double angle_rad = middle_of_bin(best);
  double within = 0.0;
  for (int k = 0; k < kRefinements; ++k) {
    double off = 0.0;
    double weights = 0.0;
    within = 0.0;
    for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
      const double away_rad = turn_between(angle_rad, middle_of_bin(bin));
      if (std::fabs(away_rad) > kWindow_rad) continue;
      const double flat = 1.0 - (away_rad / kWindow_rad) * (away_rad / kWindow_rad);
      within += weight_[bin];
      weights += flat * weight_[bin];
      off += flat * (weight_[bin] * away_rad + sum_[bin]);
    }
    if (weights > 0.0) angle_rad = in_quarter(angle_rad + off / weights);
  }
  const double share = within / all;
  if (share < kLeastShare) return std::nullopt;
  return WallDirection{turn_between(0.0, angle_rad), share};
}

}  // namespace gdtslam
