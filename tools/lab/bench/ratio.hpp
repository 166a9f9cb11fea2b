// How many times as fast a work is now as in an earlier run, from the samples of both. Thread-safe.
#pragma once

#include <cstddef>
#include <span>

namespace gdtslam {

/// Before over now: above 1 is faster now.
struct TimesRatio {
  double middle = 1.0;  ///< the median of all quotients of a sample before and one now [Hodges1963]
  double least = 1.0;   ///< the interval that goes with the test of Mann and Whitney [Mann1947]
  double most = 1.0;
  double confidence = 0.0;  ///< of the interval, at least 0.95 from four samples on each side on
};

/// Of times that are positive, one on each side at least. Supposes that the samples of a side are independent, and that
/// the two sides differ by a factor; no shape is supposed, and a few wild samples do not matter. O(n m log(n m)).
TimesRatio times_ratio(std::span<const double> before_s, std::span<const double> now_s);

/// The probability that U of Mann and Whitney is `most` or less, of samples of `n` and `m` from the same distribution
/// without ties. O(n^2 m^2), exact up to rounding.
double mann_whitney_share(std::size_t n, std::size_t m, std::size_t most);

}  // namespace gdtslam
