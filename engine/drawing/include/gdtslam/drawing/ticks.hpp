// Round values along an axis (1, 2 or 5 times a power of ten, or round angles) and readable numbers. Thread-safe; O(1).
#pragma once

#include <cstdint>
#include <string>

namespace gdtslam {

/// Kinds of round values.
enum class TickSteps : std::uint8_t {
  kDecimal,  ///< 1, 2, 5 times a power of ten
  kDegrees   ///< the same below 10, then 15, 30, 45, 90, 180, 360
};

/// Round values at equal steps.
struct Ticks {
  double first = 0.0;
  double step = 1.0;
  int count = 1;
  [[nodiscard]] double value(int number) const { return first + number * step; }
  /// Formats a number with the decimals that the step needs and a true minus sign; very large and very small values get
  /// an exponent.
  [[nodiscard]] std::string text(int number) const;
};

/// Ticks within the range, with the smallest round step that gives at most `most` steps (at least one). `from` < `to`,
/// both finite.
Ticks make_ticks(double from, double to, int most, TickSteps steps = TickSteps::kDecimal);
/// The same for the range extended outwards to whole steps.
Ticks ticks_around(double from, double to, int most, TickSteps steps = TickSteps::kDecimal);

/// "Position error (m)"; without a unit the quantity alone.
std::string axis_title(const std::string& quantity, const std::string& unit);
/// "0.0210 m": three significant figures.
std::string rounded_text(double value, const std::string& unit);
/// A whole number with a comma at every third digit.
std::string with_commas(std::uint64_t value);
/// "1 point", "2,839 points".
std::string counted(std::uint64_t value, const std::string& noun);
/// "5 mm", "20 cm", "1 m", "2 km": a length in its usual unit; a 1-2-5 length keeps all digits.
std::string length_text(double length_m);
/// The largest 1-2-5 length up to this one; 0 if there is none (not positive, not finite).
double round_length_m(double most_m);

}  // namespace gdtslam
