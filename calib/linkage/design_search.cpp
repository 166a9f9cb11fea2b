#include "design_search.hpp"

#include <algorithm>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr int kCouplerSamples = 200;
constexpr int kImbalanceSamples = 90;
/// The search along a line ends when its step, as a share of the range, is below this.
constexpr double kFinestStep = 1e-12;
/// Worse than any cosine: no linkage.
constexpr double kNoShape = 2.0;

struct Candidate {
  double cosine = kNoShape;  ///< largest of the transmission angle
  FourBar bars;
};

struct Range {
  double from = 0.0;
  double to = 0.0;
};

/// The least of a function over a range: the best of even samples, then steps that halve. It also ends well where the
/// least lies at the edge of what is allowed. `at` returns a Candidate.
template <class Function>
Candidate least_over(const Range& range, int samples, const Function& at) {
  double place = range.from;
  Candidate best;
  for (int i = 0; i <= samples; ++i) {
    const double here = range.from + (range.to - range.from) * i / samples;
    const Candidate candidate = at(here);
    if (candidate.cosine < best.cosine) {
      best = candidate;
      place = here;
    }
  }
  for (double step = 0.5 / samples; best.cosine < kNoShape && step > kFinestStep; step *= 0.5) {
    for (const double side : {-1.0, 1.0}) {
      const double here = std::clamp(place + side * step * (range.to - range.from), range.from, range.to);
      const Candidate candidate = at(here);
      if (candidate.cosine < best.cosine) {
        best = candidate;
        place = here;
        break;
      }
    }
  }
  return best;
}

Candidate candidate_of(const ShapeChoice& choice, double longest) {
  const std::optional<FourBar> bars = shape(choice);
  if (!bars || bars->rocker_m > longest || bars->ground_m > longest) {
    return {};
  }
  return {.cosine = worst_transmission_cosine(*bars), .bars = *bars};
}

Candidate best_coupler(const ShapeLimits& limits, double imbalance_rad) {
  // Even in the inverse: what happens to the angle with long couplers happens slowly.
  const auto at_inverse = [&](double inverse) {
    return candidate_of({.swing_rad = limits.swing_rad, .imbalance_rad = imbalance_rad, .coupler = 1.0 / inverse},
                        limits.longest);
  };
  return least_over({1.0 / limits.longest, 1.0}, kCouplerSamples, at_inverse);
}

}  // namespace

std::optional<FourBar> best_shape(const ShapeLimits& limits) {
  const Candidate best = limits.imbalance_rad
                             ? best_coupler(limits, *limits.imbalance_rad)
                             : least_over({0.0, 0.5 * kPi}, kImbalanceSamples,
                                          [&](double imbalance_rad) { return best_coupler(limits, imbalance_rad); });
  return best.cosine < 1.0 ? std::optional(best.bars) : std::nullopt;
}

}  // namespace gdtslam::calib
