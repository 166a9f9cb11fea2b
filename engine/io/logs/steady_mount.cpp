#include "steady_mount.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

// Doubles of some hundred metres have at most twelve decimals.
constexpr int kFewestDecimals = 6;
constexpr int kMostDecimals = 12;
constexpr std::array<double, kMostDecimals - kFewestDecimals + 1> kDecimalParts{1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11};
constexpr double kFarMount = 1000.0;  // farther than any mount; beyond, a double has too few digits for rounding

double rounded(double value, double parts) {
  if (!(std::fabs(value) < kFarMount)) return value;
  return std::floor(value * parts + 0.5) / parts + 0.0;  // no negative zero
}

}  // namespace

bool is_same_mount(const Pose2& a, const Pose2& b, double tolerance) {
  return (a.translation() - b.translation()).norm() < tolerance &&
         std::fabs(wrap_angle(a.theta_rad - b.theta_rad)) < tolerance;
}

Pose2 SteadyMount::of(const Pose2& T_base_laser, int decimals) {
  const int counted = std::clamp(decimals, kFewestDecimals, kMostDecimals);
  const double parts = kDecimalParts[static_cast<std::size_t>(counted - kFewestDecimals)];
  if (!last_ || !is_same_mount(*last_, T_base_laser, 1.0 / parts)) {
    last_ = Pose2{rounded(T_base_laser.x_m, parts), rounded(T_base_laser.y_m, parts),
                  rounded(T_base_laser.theta_rad, parts)};
  }
  return *last_;
}

}  // namespace gdtslam
