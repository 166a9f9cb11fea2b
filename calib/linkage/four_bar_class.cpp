// Which bars can turn: Grashof's inequality and whether the loop can close at all.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "four_bar_text.hpp"
#include "gdtslam/calib/four_bar.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

std::string as_text(double value, std::chars_format format, int digits) {
  std::array<char, 400> buffer{};  // a double in fixed notation has 309 digits before its point
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, digits);
  return std::string(buffer.data(), end.ptr);
}

/// Share of the sum of all bars that counts as equal in Grashof's inequality.
constexpr double kChangePointShare = 1e-9;

struct NamedBar {
  const char* name;
  double length_m;
};

std::array<NamedBar, 4> named(const FourBar& bars) {
  return {{{"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}}};
}

}  // namespace

std::string number_text(double value, int digits) { return as_text(value, std::chars_format::general, digits); }

std::string cm_text(double length_m) { return number_text(100.0 * length_m); }

std::string angle_text(double angle_rad) {
  return as_text(deg_from_rad(angle_rad), std::chars_format::fixed, 1) + " deg";
}

std::vector<std::string> violations(const FourBar& bars) {
  std::vector<std::string> result;
  const auto all = named(bars);
  for (const NamedBar& bar : all) {
    if (!std::isfinite(bar.length_m) || bar.length_m <= 0.0) {
      result.push_back(std::string("the ") + bar.name + "'s length must be a positive number, not " +
                       cm_text(bar.length_m) + " cm");
    }
  }
  if (!result.empty()) {
    return result;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::array<NamedBar, 3> others = {all[(i + 1) % 4], all[(i + 2) % 4], all[(i + 3) % 4]};
    const double reach = others[0].length_m + others[1].length_m + others[2].length_m;
    if (all[i].length_m > reach) {
      result.push_back(std::string("the loop cannot close: the ") + all[i].name + " is longer than the other three " +
                       "together, " + cm_text(all[i].length_m) + " > " + cm_text(others[0].length_m) + " + " +
                       cm_text(others[1].length_m) + " + " + cm_text(others[2].length_m) + " = " + cm_text(reach) +
                       " cm");
    }
  }
  return result;
}

GrashofInequality grashof_inequality(const FourBar& bars) {
  std::array<double, 4> sorted = {bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m};
  std::sort(sorted.begin(), sorted.end());
  return {.extremes_m = sorted[0] + sorted[3], .middles_m = sorted[1] + sorted[2]};
}

GrashofClass grashof_class(const FourBar& bars) {
  const GrashofInequality sums = grashof_inequality(bars);
  const double excess_m = sums.extremes_m - sums.middles_m;
  if (std::fabs(excess_m) <= kChangePointShare * (sums.extremes_m + sums.middles_m)) {
    return GrashofClass::kChangePoint;
  }
  if (excess_m > 0.0) {
    return GrashofClass::kTripleRocker;
  }
  const double shortest_m = std::min({bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m});
  if (shortest_m == bars.crank_m) {
    return GrashofClass::kCrankRocker;
  }
  if (shortest_m == bars.ground_m) {
    return GrashofClass::kDoubleCrank;
  }
  return shortest_m == bars.rocker_m ? GrashofClass::kRockerCrank : GrashofClass::kDoubleRocker;
}

const char* class_name(GrashofClass grashof) {
  constexpr std::array<const char*, 6> kNames{"crank-rocker",  "double crank",  "rocker-crank",
                                              "double rocker", "triple rocker", "change point"};
  return kNames.at(static_cast<std::size_t>(grashof));
}

}  // namespace gdtslam::calib
