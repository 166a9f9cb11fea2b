// Counts of values in bins that are one unit wide, the last bin open. Thread-safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace gdtslam {

/// The bin of a value, rounded to the nearest unit; values below zero are in the first bin.
inline std::size_t bin_of(double value, std::size_t bins) {
  const double bin = std::floor(value + 0.5);
  return bin < static_cast<double>(bins - 1) ? static_cast<std::size_t>(std::max(bin, 0.0)) : bins - 1;
}

/// The bin that holds the given share of all counts.
inline std::size_t quantile_bin(const std::vector<std::uint64_t>& histogram, double share) {
  const auto total = std::accumulate(histogram.begin(), histogram.end(), std::uint64_t{0});
  const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(total));
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
    sum += histogram[bin];
    if (sum > wanted) return bin;
  }
  return 0;
}

}  // namespace gdtslam
