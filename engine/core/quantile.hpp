// Values of a distribution at a share of it. Units: those of the values. Thread-safe. No value may be NaN.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace gdtslam {

/// The quantile of ascending values, at least one: interpolated between the two nearest ones (definition 7 of
/// [Hyndman1996], which NumPy and R use by default). `share` is 0 to 1. O(1).
inline double quantile_of_sorted(std::span<const double> ascending, double share) {
  assert(!ascending.empty() && share >= 0.0 && share <= 1.0);
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), ascending.size() - 1);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  return ascending[below] + (place - static_cast<double>(below)) * (ascending[above] - ascending[below]);
}

/// One of at least one values: the last that has no more than that share of the others before it. Changes the order of
/// the values. O(n).
inline double value_at_share(std::vector<double>& values, double share) {
  assert(!values.empty() && share >= 0.0 && share <= 1.0);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle one of at least one values, the upper one of two for an even number. Changes the order of the values.
/// O(n).
inline double upper_median(std::vector<double>& values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace gdtslam
