#include "design_shape.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr int kCouplerSamples = 200;
constexpr int kImbalanceSamples = 90;
/// The search along a line ends below this step, as a share of the range.
constexpr double kFinestStep = 1e-12;
/// Larger than any cosine: no linkage.
constexpr double kNoShape = 2.0;
/// The construction also gives linkages whose rocker crosses the ground line between its ends; their swing differs.
constexpr double kSameSwing_rad = 1e-6;

/// Parameters of a shape. Crank's pivot and rocker's pivot are on the same side of the line through the rocker's
/// outermost ends; crank-rockers with the other side transmit worse.
struct ShapeChoice {
  double swing_rad = 0.0;
  double imbalance_rad = 0.0;  ///< the slow stroke takes pi + imbalance of the turn, 0 to pi
  double coupler = 0.0;        ///< over the crank, above 1
};

double transmission_cosine(const FourBar& bars, double diagonal) {
  return std::fabs(bars.coupler_m * bars.coupler_m + bars.rocker_m * bars.rocker_m - diagonal * diagonal) /
         (2.0 * bars.coupler_m * bars.rocker_m);
}

bool has_swing(const FourBar& bars, double swing_rad) {
  if (grashof_class(bars) != GrashofClass::kCrankRocker) {
    return false;
  }
  const DeadPoint stretched = dead_point(bars, Assembly::kOpen, true);
  const DeadPoint folded = dead_point(bars, Assembly::kOpen, false);
  return std::fabs(std::fabs(stretched.rocker_rad - folded.rocker_rad) - swing_rad) < kSameSwing_rad;
}

/// The bars for a crank of 1; empty if the choice gives no crank-rocker with that swing.
std::optional<FourBar> shape(const ShapeChoice& choice) {
  const double coupler = choice.coupler;
  const double stretched = coupler + 1.0;
  const double folded = coupler - 1.0;
  const SinCos<double> half_imbalance = sin_cos(0.5 * choice.imbalance_rad);
  const SinCos<double> half_swing = sin_cos(0.5 * choice.swing_rad);
  const double sq_half_chord = 1.0 + stretched * folded * half_imbalance.sin * half_imbalance.sin;
  const double rocker = std::sqrt(sq_half_chord) / half_swing.sin;
  const double chord = 2.0 * std::sqrt(sq_half_chord);
  // At the stretched end, angles from the chord: to the crank's pivot, and (pi - swing) / 2 to the rocker's pivot.
  const double cosine = (stretched * stretched + chord * chord - folded * folded) / (2.0 * stretched * chord);
  const double sine = folded * 2.0 * half_imbalance.sin * half_imbalance.cos / chord;
  const double pivots_cosine = half_swing.sin * cosine + half_swing.cos * sine;
  const double sq_ground = stretched * stretched + rocker * rocker - 2.0 * stretched * rocker * pivots_cosine;
  const FourBar bars{
      .crank_m = 1.0, .coupler_m = coupler, .rocker_m = rocker, .ground_m = std::sqrt(std::max(0.0, sq_ground))};
  return has_swing(bars, choice.swing_rad) ? std::optional(bars) : std::nullopt;
}

/// The largest |cos| of the transmission angle over a turn.
double worst_transmission_cosine(const FourBar& bars) {
  return std::max(transmission_cosine(bars, bars.ground_m - bars.crank_m),
                  transmission_cosine(bars, bars.ground_m + bars.crank_m));
}

struct Candidate {
  double cosine = kNoShape;  ///< largest cosine of the transmission angle
  FourBar bars;
};

struct Range {
  double from = 0.0;
  double to = 0.0;
};

/// Minimises a function over a range: the best of even samples, then halved steps. A minimum at the edge of the
/// feasible range is found too. `at` returns a Candidate.
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

Candidate make_candidate(const ShapeChoice& choice, double longest) {
  const std::optional<FourBar> bars = shape(choice);
  if (!bars || bars->rocker_m > longest || bars->ground_m > longest) {
    return {};
  }
  return {.cosine = worst_transmission_cosine(*bars), .bars = *bars};
}

Candidate best_coupler(const ShapeLimits& limits, double imbalance_rad) {
  // Even in the inverse, because the angle changes slowly for long couplers.
  const auto at_inverse = [&](double inverse) {
    return make_candidate({.swing_rad = limits.swing_rad, .imbalance_rad = imbalance_rad, .coupler = 1.0 / inverse},
                          limits.longest);
  };
  return least_over({1.0 / limits.longest, 1.0}, kCouplerSamples, at_inverse);
}

// The feasible choices of a grid and their ranges; the grid's ranges if none is feasible.
struct Feasible {
  std::vector<FourBar> shapes;
  Range imbalance_rad;
  Range inverse;
};

void widen(Range& range, double value) {
  range.from = std::min(range.from, value);
  range.to = std::max(range.to, value);
}

// Each range widened by one step of the grid, but not beyond `most`.
Range with_a_step(const Range& range, const Range& grid, int samples, const Range& most) {
  const double step = (grid.to - grid.from) / samples;
  return {std::max(most.from, range.from - step), std::min(most.to, range.to + step)};
}

void add_grid(const ShapeLimits& limits, const Range& imbalances, const Range& inverses, double most_cosine,
              Feasible& all) {
  const int rows = imbalances.to > imbalances.from ? kImbalanceSamples : 0;
  for (int i = 0; i <= rows; ++i) {
    const double imbalance_rad =
        imbalances.from + (rows > 0 ? (imbalances.to - imbalances.from) * i / static_cast<double>(rows) : 0.0);
    for (int k = 0; k <= kCouplerSamples; ++k) {
      const double inverse = inverses.from + (inverses.to - inverses.from) * k / kCouplerSamples;
      const Candidate candidate = make_candidate(
          {.swing_rad = limits.swing_rad, .imbalance_rad = imbalance_rad, .coupler = 1.0 / inverse}, limits.longest);
      if (!(candidate.cosine <= most_cosine)) continue;
      all.shapes.push_back(candidate.bars);
      widen(all.imbalance_rad, imbalance_rad);
      widen(all.inverse, inverse);
    }
  }
}

}  // namespace

double imbalance_of_time_ratio(double time_ratio) { return kPi * (time_ratio - 1.0) / (time_ratio + 1.0); }

std::optional<FourBar> best_shape(const ShapeLimits& limits) {
  const Candidate best = limits.imbalance_rad
                             ? best_coupler(limits, *limits.imbalance_rad)
                             : least_over({0.0, 0.5 * kPi}, kImbalanceSamples,
                                          [&](double imbalance_rad) { return best_coupler(limits, imbalance_rad); });
  return best.cosine < 1.0 ? std::optional(best.bars) : std::nullopt;
}

std::vector<FourBar> shapes_above(const ShapeLimits& limits, double least_transmission_rad, const FourBar& best) {
  const double most_cosine = sin_cos(least_transmission_rad).cos;
  const Range imbalances =
      limits.imbalance_rad ? Range{*limits.imbalance_rad, *limits.imbalance_rad} : Range{0.0, 0.5 * kPi};
  const Range inverses{1.0 / limits.longest, 1.0};
  const double best_rad = imbalance_of_time_ratio(analyse(best, Assembly::kOpen).time_ratio);
  const double best_inverse = best.crank_m / best.coupler_m;
  Feasible found{{best}, {best_rad, best_rad}, {best_inverse, best_inverse}};
  add_grid(limits, imbalances, inverses, most_cosine, found);
  const Range near_imbalances = with_a_step(found.imbalance_rad, imbalances, kImbalanceSamples, imbalances);
  const Range near_inverses = with_a_step(found.inverse, inverses, kCouplerSamples, inverses);
  add_grid(limits, near_imbalances, near_inverses, most_cosine, found);
  return std::move(found.shapes);
}

}  // namespace gdtslam::calib
