#include "gdtslam/drawing/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gdtslam {
namespace {

/// Tolerance of a tick beyond its range, as share of a step, because sums of steps are inexact.
constexpr double kSlack = 1e-6;
constexpr int kMostDecimals = 9;
constexpr double kPlainMost = 1e7;

double power_of_ten(int exponent) {
  double power = 1.0;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10.0;
  return exponent < 0 ? 1.0 / power : power;
}

/// The least 1, 2 or 5 times a power of ten that is not below `least`.
double round_up(double least) {
  constexpr int kLeastExponent = -300;
  int exponent = 0;
  while (power_of_ten(exponent) > least && exponent > kLeastExponent) --exponent;
  while (power_of_ten(exponent + 1) <= least) ++exponent;
  // Values just above one by rounding count as equal.
  for (const double digit : {1.0, 2.0, 5.0}) {
    const double step = exponent < 0 ? digit / power_of_ten(-exponent) : digit * power_of_ten(exponent);
    if (step >= least * (1.0 - 1e-12)) return step;
  }
  return power_of_ten(exponent + 1);
}

double round_step(double from, double to, int most, TickSteps steps) {
  const double least = (to - from) / std::max(1, most);
  constexpr std::array kAngles{15.0, 30.0, 45.0, 90.0, 180.0, 360.0};
  const double round = round_up(least);
  if (steps == TickSteps::kDecimal || round <= 10.0) return round;
  const auto* const angle = std::find_if(kAngles.begin(), kAngles.end(), [least](double a) { return a >= least; });
  return angle == kAngles.end() ? 360.0 * std::ceil(least / 360.0) : *angle;
}

int count_decimals(double step) {
  double scaled = step;
  for (int decimals = 0; decimals < kMostDecimals; ++decimals, scaled *= 10.0) {
    if (std::fabs(scaled - std::floor(scaled + 0.5)) < 1e-6 * scaled) return decimals;
  }
  return kMostDecimals;
}

}  // namespace

std::string Ticks::text(int number) const {
  const double exact = value(number);
  const double shown = std::fabs(exact) < kSlack * step ? 0.0 : exact;
  const bool is_plain = std::fabs(shown) < kPlainMost && step >= 1e-6;
  std::string text = is_plain ? fmt::format("{:.{}f}", std::fabs(shown), count_decimals(step))
                              : fmt::format("{:.6g}", std::fabs(shown));
  return shown < 0.0 ? "\xE2\x88\x92" + text : text;
}

Ticks make_ticks(double from, double to, int most, TickSteps steps) {
  Ticks ticks;
  ticks.step = round_step(from, to, most, steps);
  const double first = std::ceil(from / ticks.step - kSlack);
  const double last = std::floor(to / ticks.step + kSlack);
  ticks.first = first * ticks.step;
  ticks.count = static_cast<int>(std::clamp(last - first, -1.0, most + 1.0)) + 1;
  return ticks;
}

Ticks ticks_around(double from, double to, int most, TickSteps steps) {
  Ticks ticks;
  ticks.step = round_step(from, to, most, steps);
  const double first = std::floor(from / ticks.step + kSlack);
  const double last = std::ceil(to / ticks.step - kSlack);
  ticks.first = first * ticks.step;
  ticks.count = static_cast<int>(std::clamp(last - first, 0.0, most + 2.0)) + 1;
  return ticks;
}

double round_length_m(double most_m) {
  if (!(most_m > 0.0) || !std::isfinite(most_m) || most_m < 1e-9) return 0.0;
  const double above = round_up(most_m);
  if (above <= most_m) return above;
  // The next smaller step of 1, 2, 5: a half, or two fifths of a five.
  for (const double share : {0.5, 0.4}) {
    const double below = round_up(above * share);
    if (below <= most_m) return below;
  }
  return 0.0;
}

std::string axis_title(const std::string& quantity, const std::string& unit) {
  return unit.empty() ? quantity : quantity + " (" + unit + ")";
}

std::string rounded_text(double value, const std::string& unit) {
  const double size = std::fabs(value);
  std::string number = size < 1000.0 ? fmt::format("{:#.3g}", size) : fmt::format("{:.0f}", size);
  if (number.ends_with('.')) number.pop_back();
  // The same minus sign as on the axes.
  return (value < 0.0 ? "\xE2\x88\x92" : "") + number + (unit.empty() ? "" : " " + unit);
}

std::string with_commas(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t k = text.size(); k > 3;) text.insert(k -= 3, ",");
  return text;
}

std::string counted(std::uint64_t value, const std::string& noun) {
  return with_commas(value) + " " + noun + (value == 1 ? "" : "s");
}

std::string length_text(double length_m) {
  struct LengthUnit {
    double length_m;
    const char* name;
  };
  for (const LengthUnit& unit : {LengthUnit{1000.0, "km"}, LengthUnit{1.0, "m"}, LengthUnit{0.01, "cm"}}) {
    if (length_m >= unit.length_m * (1.0 - 1e-9)) return fmt::format("{:.6g} {}", length_m / unit.length_m, unit.name);
  }
  return fmt::format("{:.6g} mm", length_m * 1000.0);
}

}  // namespace gdtslam
