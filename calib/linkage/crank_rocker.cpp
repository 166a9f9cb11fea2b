#include "gdtslam/calib/crank_rocker.hpp"

#include <algorithm>
#include <cmath>

#include "design_shape.hpp"
#include "engine/core/elementary.hpp"
#include "four_bar_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

/// Samples of a turn that bracket the extremes of the rate, of which there are at most a handful.
constexpr int kRateSamples = 720;
/// Halvings of a sample step, to below the rounding of an angle.
constexpr int kHalvings = 48;
/// Share of a turn: strokes with a smaller difference are equal, and the crank's direction does not matter.
constexpr double kEqualStrokes = 1e-9;
constexpr double kNearChangePoint = 0.02;
constexpr double kSensitiveRate = 2.0;

double turn_share(double from_rad, double to_rad) {
  const double turns = (to_rad - from_rad) / kTwoPi;
  return turns - std::floor(turns);
}

double rocker_acceleration(const FourBar& bars, Assembly assembly, double crank_rad) {
  return motion(bars, assembly, crank_rad).value().rocker_acceleration;
}

/// Largest |d psi / d phi|, at a sign change of the acceleration.
double most_rocker_rate(const FourBar& bars, Assembly assembly) {
  double most = 0.0;
  double low = 0.0;
  double at_low = rocker_acceleration(bars, assembly, low);
  for (int i = 1; i <= kRateSamples; ++i) {
    const double next = kTwoPi * i / kRateSamples;
    const double at_next = rocker_acceleration(bars, assembly, next);
    if ((at_low < 0.0) != (at_next < 0.0)) {
      double high = next;
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = 0.5 * (low + high);
        const bool is_left = (rocker_acceleration(bars, assembly, middle) < 0.0) == (at_low < 0.0);
        (is_left ? low : high) = middle;
      }
      most = std::max(most, std::fabs(motion(bars, assembly, low).value().rocker_rate));
    }
    low = next;
    at_low = at_next;
  }
  return most;
}

void require_crank_rocker(const FourBar& bars) {
  const std::vector<std::string> wrong = violations(bars);
  if (!wrong.empty()) {
    throw ConfigError(wrong.front());
  }
  const GrashofClass found = grashof_class(bars);
  if (found == GrashofClass::kCrankRocker) {
    return;
  }
  if (found == GrashofClass::kTripleRocker || found == GrashofClass::kChangePoint) {
    throw ConfigError("the crank cannot turn fully: " + inequality_text(bars) +
                      "; shorten the shortest or the longest bar");
  }
  throw ConfigError("the linkage is a " + std::string(class_name(found)) + ", no crank-rocker: the crank, " +
                    cm_text(bars.crank_m) + " cm, must be the shortest bar");
}

}  // namespace

// At the rocker's limits crank and coupler are in line: the rocker's end is coupler + crank (stretched) or coupler -
// crank (folded) away from the crank's pivot. Solved in the triangle of the two pivots and the rocker's end.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched) {
  const double reach = is_stretched ? bars.coupler_m + bars.crank_m : bars.coupler_m - bars.crank_m;
  const double x =
      (reach * reach + bars.ground_m * bars.ground_m - bars.rocker_m * bars.rocker_m) / (2.0 * bars.ground_m);
  const double height = std::sqrt(std::max(0.0, (reach - x) * (reach + x)));
  const double y = assembly == Assembly::kOpen ? height : -height;
  const double crank_rad = is_stretched ? atan2(y, x) : atan2(-y, -x);
  return {.crank_rad = crank_rad, .rocker_rad = atan2(y, x - bars.ground_m)};
}

std::string inequality_text(const FourBar& bars) {
  const GrashofInequality sums = grashof_inequality(bars);
  const GrashofClass found = grashof_class(bars);
  const char* relation = found == GrashofClass::kChangePoint ? " = " : sums.extremes_m < sums.middles_m ? " < " : " > ";
  return "shortest + longest" + std::string(relation) + "the other two, " + cm_text(sums.extremes_m) + relation +
         cm_text(sums.middles_m) + " cm";
}

double least_transmission_rad(const FourBar& bars) {
  return std::min(solve(bars, Assembly::kOpen, 0.0).value().transmission_rad,
                  solve(bars, Assembly::kOpen, kPi).value().transmission_rad);
}

CrankRockerReport analyse(const FourBar& bars, Assembly assembly) {
  require_crank_rocker(bars);
  const DeadPoint stretched = dead_point(bars, assembly, true);
  const DeadPoint folded = dead_point(bars, assembly, false);
  const bool rises_to_stretched = stretched.rocker_rad > folded.rocker_rad;
  CrankRockerReport report;
  report.lowest = rises_to_stretched ? folded : stretched;
  report.highest = rises_to_stretched ? stretched : folded;
  report.swing_rad = report.highest.rocker_rad - report.lowest.rocker_rad;
  const double counter_clockwise = turn_share(report.lowest.crank_rad, report.highest.crank_rad);
  report.lift_direction = counter_clockwise > 0.5 - kEqualStrokes ? 1 : -1;
  report.lift_share = std::max(counter_clockwise, 1.0 - counter_clockwise);
  report.time_ratio = report.lift_share / (1.0 - report.lift_share);
  report.least_transmission_rad = least_transmission_rad(bars);
  report.most_rocker_rate = most_rocker_rate(bars, assembly);
  return report;
}

std::vector<std::string> remarks(const FourBar& bars, Assembly assembly) {
  const CrankRockerReport report = analyse(bars, assembly);
  std::vector<std::string> result;
  if (report.least_transmission_rad < kPoorTransmission_rad) {
    const double sine = sin_cos(report.least_transmission_rad).sin;
    result.push_back(
        "the transmission angle falls to " + angle_text(report.least_transmission_rad) + ", below 40 deg: there only " +
        number_text(100.0 * sine, 2) +
        " % of the coupler's force turns the rocker and the rest loads its pivots, an error of the coupler's length "
        "or play in a joint moves the rocker " +
        number_text(1.0 / sine, 2) + " times as far as at 90 deg, and the mount rattles when loads reverse");
  }
  const GrashofInequality sums = grashof_inequality(bars);
  const double margin_m = sums.middles_m - sums.extremes_m;
  if (margin_m < kNearChangePoint * (sums.middles_m + sums.extremes_m)) {
    result.push_back("the linkage is next to a change point: " + inequality_text(bars) + ", " + cm_text(margin_m) +
                     " cm apart; an error of that size in a length stops the crank or lets the mode flip");
  }
  if (report.most_rocker_rate > kSensitiveRate) {
    result.push_back("the rocker turns up to " + number_text(report.most_rocker_rate, 3) +
                     " times as fast as the crank: one step of the crank's encoder is that many steps of elevation");
  }
  return result;
}

}  // namespace gdtslam::calib
