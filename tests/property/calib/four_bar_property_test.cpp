// Laws of the four-bar linkage for random lengths, angles and both assembly modes: the loop closes, the mode holds,
// derivatives are those of finite differences, identities that the closed form does not use. Sines and cosines are the
// C library's here.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr int kCentimetres = 10000;

double random_length() { return 0.01 + 0.2 * *rc::gen::inRange(0, kCentimetres) / kCentimetres; }
double random_angle() { return kTwoPi * *rc::gen::inRange(-kCentimetres, kCentimetres) / kCentimetres; }
Assembly random_assembly() { return *rc::gen::element(Assembly::kOpen, Assembly::kCrossed); }

FourBar random_bars() {
  return {.crank_m = random_length(),
          .coupler_m = random_length(),
          .rocker_m = random_length(),
          .ground_m = random_length()};
}

/// Crank-rockers away from a change point.
FourBar random_crank_rocker() {
  FourBar bars = random_bars();
  bars.crank_m = 0.95 * std::min({bars.coupler_m, bars.rocker_m, bars.ground_m});
  const double longest = std::max({bars.coupler_m, bars.rocker_m, bars.ground_m});
  const double others = bars.coupler_m + bars.rocker_m + bars.ground_m - longest;
  RC_PRE(others - longest > 0.02 * longest);
  bars.crank_m = std::min(bars.crank_m, 0.9 * (others - longest));
  return bars;
}

Point2 direction(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
Point2 crank_end(const FourBar& bars, double crank_rad) { return bars.crank_m * direction(crank_rad); }
Point2 pivot(const FourBar& bars) { return {bars.ground_m, 0.0}; }

double size_of(const FourBar& bars) { return bars.crank_m + bars.coupler_m + bars.rocker_m + bars.ground_m; }
double wrapped(double angle_rad) { return std::remainder(angle_rad, kTwoPi); }

RC_GTEST_PROP(FourBarLaws, TheLoopClosesInTheModeThatWasAskedFor, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const Assembly assembly = random_assembly();
  const auto pose = solve(bars, assembly, crank_rad);
  RC_PRE(pose.has_value());
  const Point2 a = crank_end(bars, crank_rad);
  const Point2 by_coupler = a + bars.coupler_m * direction(pose->coupler_rad);
  const Point2 by_rocker = pivot(bars) + bars.rocker_m * direction(pose->rocker_rad);
  RC_ASSERT((by_coupler - by_rocker).norm() < 1e-9 * size_of(bars));
  const Point2 to_pivot = pivot(bars) - a;
  const Point2 to_b = by_coupler - a;
  const double side = to_pivot.x() * to_b.y() - to_pivot.y() * to_b.x();
  RC_ASSERT((assembly == Assembly::kOpen ? side : -side) > -1e-9 * size_of(bars) * size_of(bars));
  const double between = std::fabs(wrapped(pose->coupler_rad - pose->rocker_rad));
  RC_ASSERT(std::fabs(std::min(between, kPi - between) - pose->transmission_rad) < 1e-6);
}

RC_GTEST_PROP(FourBarLaws, ItClosesExactlyWhereTheTriangleInequalityHolds, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const double diagonal = (pivot(bars) - crank_end(bars, crank_rad)).norm();
  const double room =
      std::min(bars.coupler_m + bars.rocker_m - diagonal, diagonal - std::fabs(bars.coupler_m - bars.rocker_m));
  RC_PRE(std::fabs(room) > 1e-9);
  RC_ASSERT(solve(bars, random_assembly(), crank_rad).has_value() == (room > 0.0));
  bool is_in_range = false;
  for (const CrankRange& range : crank_ranges(bars)) {
    const double middle = 0.5 * (range.from_rad + range.to_rad);
    is_in_range |= std::fabs(wrapped(crank_rad - middle)) <= 0.5 * (range.to_rad - range.from_rad);
  }
  RC_ASSERT(is_in_range == (room > 0.0));
}

RC_GTEST_PROP(FourBarLaws, ModesAreMirrorImages, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const auto open = solve(bars, Assembly::kOpen, crank_rad);
  const auto crossed = solve(bars, Assembly::kCrossed, -crank_rad);
  RC_ASSERT(open.has_value() == crossed.has_value());
  RC_PRE(open.has_value());
  RC_ASSERT(std::fabs(wrapped(open->rocker_rad + crossed->rocker_rad)) < 1e-12);
  RC_ASSERT(std::fabs(wrapped(open->coupler_rad + crossed->coupler_rad)) < 1e-12);
}

RC_GTEST_PROP(FourBarLaws, FreudensteinsEquationHolds, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const auto pose = solve(bars, random_assembly(), crank_rad);
  RC_PRE(pose.has_value());
  const FreudensteinCoefficients k = freudenstein(bars);
  const double left = k.k1 * std::cos(pose->rocker_rad) - k.k2 * std::cos(crank_rad) + k.k3;
  RC_ASSERT(std::fabs(left - std::cos(crank_rad - pose->rocker_rad)) < 1e-9 * (1.0 + k.k1 + k.k2 + std::fabs(k.k3)));
}

/// A place where finite differences are good: the coupler at least 12 deg off the rocker's line.
bool is_smooth(const FourBar& bars, Assembly assembly, double crank_rad) {
  const auto pose = solve(bars, assembly, crank_rad);
  return pose && pose->transmission_rad > 0.2 && (pivot(bars) - crank_end(bars, crank_rad)).norm() > 0.02;
}

RC_GTEST_PROP(FourBarLaws, RatesAreThoseOfFiniteDifferences, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const Assembly assembly = random_assembly();
  RC_PRE(is_smooth(bars, assembly, crank_rad));
  const double rate = 0.1 * *rc::gen::inRange(-30, 30);
  const double acceleration = 0.1 * *rc::gen::inRange(-30, 30);
  const auto found = motion(bars, assembly, crank_rad, rate, acceleration);
  RC_ASSERT(found.has_value());
  // The crank's course phi(t) = phi + rate t + acceleration t^2 / 2.
  const double h = 1e-4;
  const auto at = [&](double t) {
    return solve(bars, assembly, crank_rad + rate * t + 0.5 * acceleration * t * t).value();
  };
  const LinkagePose before = at(-h);
  const LinkagePose here = at(0.0);
  const LinkagePose after = at(h);
  const auto first = [h](double b, double a) { return wrapped(a - b) / (2.0 * h); };
  const auto second = [h](double b, double x, double a) { return (wrapped(a - x) - wrapped(x - b)) / (h * h); };
  const double scale = 1.0 + std::fabs(rate) * std::fabs(rate) * std::fabs(rate) + std::fabs(acceleration);
  const double size = scale * std::pow(size_of(bars) / std::min(bars.coupler_m, bars.rocker_m), 2.0);
  RC_ASSERT(std::fabs(found->rocker_rate - first(before.rocker_rad, after.rocker_rad)) < 1e-4 * size);
  RC_ASSERT(std::fabs(found->coupler_rate - first(before.coupler_rad, after.coupler_rad)) < 1e-4 * size);
  RC_ASSERT(std::fabs(found->rocker_acceleration - second(before.rocker_rad, here.rocker_rad, after.rocker_rad)) <
            1e-3 * size);
  RC_ASSERT(std::fabs(found->coupler_acceleration - second(before.coupler_rad, here.coupler_rad, after.coupler_rad)) <
            1e-3 * size);
}

RC_GTEST_PROP(FourBarLaws, SensitivitiesAreThoseOfFiniteDifferences, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const Assembly assembly = random_assembly();
  RC_PRE(is_smooth(bars, assembly, crank_rad));
  const auto found = sensitivity(bars, assembly, crank_rad);
  RC_ASSERT(found.has_value());
  const auto numeric = [&](double FourBar::*length) {
    constexpr double kStep_m = 1e-7;
    FourBar longer = bars;
    FourBar shorter = bars;
    longer.*length += kStep_m;
    shorter.*length -= kStep_m;
    const double after = solve(longer, assembly, crank_rad).value().rocker_rad;
    const double before = solve(shorter, assembly, crank_rad).value().rocker_rad;
    return wrapped(after - before) / (2.0 * kStep_m);
  };
  const double tolerance = 1e-5 / std::min({bars.rocker_m, bars.coupler_m, 0.05});
  RC_ASSERT(std::fabs(found->crank - numeric(&FourBar::crank_m)) < tolerance);
  RC_ASSERT(std::fabs(found->coupler - numeric(&FourBar::coupler_m)) < tolerance);
  RC_ASSERT(std::fabs(found->rocker - numeric(&FourBar::rocker_m)) < tolerance);
  RC_ASSERT(std::fabs(found->ground - numeric(&FourBar::ground_m)) < tolerance);
  // A linkage that grows as a whole keeps its angles.
  const double growth = bars.crank_m * found->crank + bars.coupler_m * found->coupler + bars.rocker_m * found->rocker +
                        bars.ground_m * found->ground;
  RC_ASSERT(std::fabs(growth) < 1e-9 * size_of(bars) / bars.rocker_m);
}

RC_GTEST_PROP(FourBarLaws, CouplerPointsKeepTheirPlaceOnTheCoupler, ()) {
  const FourBar bars = random_bars();
  const double crank_rad = random_angle();
  const double along = 0.3 - random_length();
  const double across = 0.1 - random_length();
  const auto point = coupler_point(bars, random_assembly(), crank_rad, along, across);
  RC_PRE(point.has_value());
  RC_ASSERT(std::fabs((*point - crank_end(bars, crank_rad)).norm() - std::hypot(along, across)) < 1e-9);
}

RC_GTEST_PROP(FourBarLaws, TheModeHoldsOverAWholeTurn, ()) {
  const FourBar bars = random_crank_rocker();
  const Assembly assembly = random_assembly();
  const double direction = *rc::gen::element(-1.0, 1.0);
  const double start = random_angle();
  const double most_rate = analyse(bars, assembly).most_rocker_rate;
  constexpr int kSteps = 1440;
  const LinkagePose first = solve(bars, assembly, start).value();
  double last_rad = first.rocker_rad;
  for (int i = 1; i <= kSteps; ++i) {
    const LinkagePose pose = solve(bars, assembly, start + direction * kTwoPi * i / kSteps).value();
    RC_ASSERT(std::fabs(pose.rocker_rad - last_rad) <= most_rate * kTwoPi / kSteps + 1e-9);
    RC_ASSERT(pose.transmission_rad > 0.0);
    RC_ASSERT((pose.rocker_rad > 0.0) == (assembly == Assembly::kOpen));  // a rocker never crosses the ground line
    last_rad = pose.rocker_rad;
  }
  RC_ASSERT(std::fabs(last_rad - first.rocker_rad) < 1e-9);
}

RC_GTEST_PROP(FourBarLaws, GrashofsClassIsWhatTurns, ()) {
  const FourBar bars = random_bars();
  const GrashofInequality sums = grashof_inequality(bars);
  RC_PRE(violations(bars).empty() && std::fabs(sums.extremes_m - sums.middles_m) > 1e-3);
  const auto turns = [](const FourBar& frame) {
    for (int i = 0; i < 720; ++i) {
      if (!solve(frame, Assembly::kOpen, kTwoPi * i / 720)) {
        return false;
      }
    }
    return true;
  };
  // The rocker as the crank of the linkage seen from the other side.
  const FourBar reversed{bars.rocker_m, bars.coupler_m, bars.crank_m, bars.ground_m};
  const GrashofClass found = grashof_class(bars);
  const bool crank_turns = found == GrashofClass::kCrankRocker || found == GrashofClass::kDoubleCrank;
  const bool rocker_turns = found == GrashofClass::kRockerCrank || found == GrashofClass::kDoubleCrank;
  RC_ASSERT(turns(bars) == crank_turns);
  RC_ASSERT(turns(reversed) == rocker_turns);
}

RC_GTEST_PROP(FourBarLaws, NoCrankRockerBeatsNinetyDegreesLessHalfItsSwing, ()) {
  const FourBar bars = random_crank_rocker();
  const CrankRockerReport report = analyse(bars, Assembly::kOpen);
  RC_ASSERT(report.least_transmission_rad < 0.5 * (kPi - report.swing_rad));
}

}  // namespace
}  // namespace gdtslam::calib
