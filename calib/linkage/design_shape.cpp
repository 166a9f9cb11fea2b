#include "design_shape.hpp"

#include <algorithm>
#include <cmath>

#include "crank_rocker_dead_points.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

/// The construction also gives linkages whose rocker crosses the ground line between its ends; their swing is another.
constexpr double kSameSwing_rad = 1e-6;

double transmission_cosine(const FourBar& bars, double diagonal) {
  return std::fabs(bars.coupler_m * bars.coupler_m + bars.rocker_m * bars.rocker_m - diagonal * diagonal) /
         (2.0 * bars.coupler_m * bars.rocker_m);
}

bool has_swing(const FourBar& bars, double swing_rad) {
  if (grashof_class(bars) != GrashofClass::kCrankRocker) {
    return false;
  }
  const DeadPoint stretched = dead_point(bars, Assembly::kOpen, true);
  const DeadPoint folded = dead_point(bars, Assembly::kOpen, false);
  return std::fabs(std::fabs(stretched.rocker_rad - folded.rocker_rad) - swing_rad) < kSameSwing_rad;
}

}  // namespace

std::optional<FourBar> shape(const ShapeChoice& choice) {
  const double coupler = choice.coupler;
  const double stretched = coupler + 1.0;
  const double folded = coupler - 1.0;
  const SinCos<double> half_imbalance = sin_cos(0.5 * choice.imbalance_rad);
  const SinCos<double> half_swing = sin_cos(0.5 * choice.swing_rad);
  const double sq_half_chord = 1.0 + stretched * folded * half_imbalance.sin * half_imbalance.sin;
  const double rocker = std::sqrt(sq_half_chord) / half_swing.sin;
  const double chord = 2.0 * std::sqrt(sq_half_chord);
  // At the stretched end, from the chord: the crank's pivot, and the rocker's pivot at (pi - swing) / 2.
  const double cosine = (stretched * stretched + chord * chord - folded * folded) / (2.0 * stretched * chord);
  const double sine = folded * 2.0 * half_imbalance.sin * half_imbalance.cos / chord;
  const double pivots_cosine = half_swing.sin * cosine + half_swing.cos * sine;
  const double sq_ground = stretched * stretched + rocker * rocker - 2.0 * stretched * rocker * pivots_cosine;
  const FourBar bars{
      .crank_m = 1.0, .coupler_m = coupler, .rocker_m = rocker, .ground_m = std::sqrt(std::max(0.0, sq_ground))};
  return has_swing(bars, choice.swing_rad) ? std::optional(bars) : std::nullopt;
}

double worst_transmission_cosine(const FourBar& bars) {
  return std::max(transmission_cosine(bars, bars.ground_m - bars.crank_m),
                  transmission_cosine(bars, bars.ground_m + bars.crank_m));
}

double imbalance_of_time_ratio(double time_ratio) { return kPi * (time_ratio - 1.0) / (time_ratio + 1.0); }

}  // namespace gdtslam::calib
