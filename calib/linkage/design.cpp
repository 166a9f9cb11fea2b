#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "design_shape.hpp"
#include "four_bar_text.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kDefaultLongestRatio = 4.0;
/// Bars longer than this many cranks gain nothing more: the transmission angle is within 0.02 deg of its limit.
constexpr double kLongestUseful = 64.0;
constexpr int kLengthHalvings = 12;
/// Angle difference below the resolution of the search.
constexpr double kEqualAngle_rad = 1e-9;

/// Crank, coupler, rocker and ground as shares of their sum, which do not depend on the linkage's size.
std::array<double, 4> bar_shares(const FourBar& bars) {
  const double sum = bars.crank_m + bars.coupler_m + bars.rocker_m + bars.ground_m;
  return {bars.crank_m / sum, bars.coupler_m / sum, bars.rocker_m / sum, bars.ground_m / sum};
}

/// Distance between the shares of two linkages.
double shape_distance(const FourBar& a, const FourBar& b) {
  const std::array<double, 4> of_a = bar_shares(a);
  const std::array<double, 4> of_b = bar_shares(b);
  double sum = 0.0;
  for (std::size_t k = 0; k < of_a.size(); ++k) sum += (of_a[k] - of_b[k]) * (of_a[k] - of_b[k]);
  return std::sqrt(sum);
}

/// Shapes at a smaller distance count as equal: half a percent of the sum of the bars.
constexpr double kSameShape = 0.005;

/// Farthest-point sampling [Gonzalez1985]: takes the first shape, then each time the one farthest from all taken, the
/// first of equals. So no shape is farther from the taken ones than these are from each other. Fewer than `count` if
/// all others are nearer than kSameShape. O(count x shapes).
std::vector<FourBar> spread_shapes(std::span<const FourBar> shapes, std::size_t count) {
  std::vector<FourBar> taken;
  if (shapes.empty()) return taken;
  std::vector<double> nearest(shapes.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (taken.size() < count && nearest[next] >= kSameShape) {
    taken.push_back(shapes[next]);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      nearest[k] = std::min(nearest[k], shape_distance(shapes[k], taken.back()));
    }
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  return taken;
}

struct Reached {
  FourBar bars;
  double transmission_rad = 0.0;
};

double longest_bar_m(const DesignGoal& goal) {
  return goal.longest_bar_m.value_or(std::min(kDefaultLongestRatio * goal.most_crank_m, kMostBar_m));
}

/// The best linkage with this crank length and bars up to `longest_m`.
std::optional<Reached> best_with(const DesignGoal& goal, double crank_m, double longest_m) {
  const auto imbalance = goal.time_ratio ? std::optional(imbalance_of_time_ratio(*goal.time_ratio)) : std::nullopt;
  const std::optional<FourBar> found =
      best_shape({.swing_rad = goal.swing_rad, .imbalance_rad = imbalance, .longest = longest_m / crank_m});
  if (!found) {
    return std::nullopt;
  }
  const FourBar bars{.crank_m = crank_m,
                     .coupler_m = crank_m * found->coupler_m,
                     .rocker_m = crank_m * found->rocker_m,
                     .ground_m = crank_m * found->ground_m};
  return Reached{.bars = bars, .transmission_rad = least_transmission_rad(bars)};
}

bool meets(const std::optional<Reached>& reached, const DesignGoal& goal) {
  return reached && reached->transmission_rad >= goal.min_transmission_rad - kEqualAngle_rad;
}

void require(bool condition, const std::string& message) {
  if (!condition) {
    throw ConfigError(message);
  }
}

/// A designed linkage must pass validate().
void require_bars_of_a_mount(const DesignGoal& goal) {
  require(goal.least_crank_m >= kLeastBar_m,
          "a crank of " + number_text(1000.0 * goal.least_crank_m) + " mm is shorter than 1 mm; check its unit");
  require(goal.most_crank_m <= kMostBar_m,
          "a crank of " + cm_text(goal.most_crank_m) + " cm is longer than 1 m; check its unit");
  require(longest_bar_m(goal) <= kMostBar_m,
          "a longest bar of " + cm_text(longest_bar_m(goal)) + " cm is longer than 1 m; check its unit");
}

/// Checks each number of the goal by itself.
void require_sound(const DesignGoal& goal) {
  require(goal.swing_rad > 0.0 && goal.swing_rad < kPi,
          "the swing of a crank-rocker lies between 0 and 180 deg, not at " + angle_text(goal.swing_rad));
  require(goal.min_transmission_rad > 0.0 && goal.min_transmission_rad < 0.5 * kPi,
          "the least transmission angle lies between 0 and 90 deg, not at " + angle_text(goal.min_transmission_rad));
  require(!goal.time_ratio || (*goal.time_ratio >= 1.0 && std::isfinite(*goal.time_ratio)),
          "the time ratio, slow over quick stroke, is at least 1, not " + number_text(goal.time_ratio.value_or(1.0)));
  require(goal.least_crank_m > 0.0 && goal.least_crank_m <= goal.most_crank_m && std::isfinite(goal.most_crank_m),
          "the crank's range must be positive and rising, not " + cm_text(goal.least_crank_m) + ".." +
              cm_text(goal.most_crank_m) + " cm");
  require_bars_of_a_mount(goal);
  require(longest_bar_m(goal) > goal.least_crank_m && std::isfinite(longest_bar_m(goal)),
          "the longest bar, " + cm_text(longest_bar_m(goal)) + " cm, must be longer than the shortest crank, " +
              cm_text(goal.least_crank_m) + " cm");
}

/// Refuses a goal whose swing alone is impossible for any lengths.
void require_possible(const DesignGoal& goal) {
  const double most_rad = 0.5 * (kPi - goal.swing_rad);
  require(goal.min_transmission_rad < most_rad,
          "a swing of " + angle_text(goal.swing_rad) + " keeps every crank-rocker's transmission angle below " +
              angle_text(most_rad) + " (90 deg less half the swing), and " + angle_text(goal.min_transmission_rad) +
              " are asked for; ask for less of one of them");
}

std::string goal_text(const DesignGoal& goal) {
  std::string text = "a swing of " + angle_text(goal.swing_rad);
  if (goal.time_ratio) {
    text += " and a time ratio of " + number_text(*goal.time_ratio);
  }
  return text;
}

/// The smallest limit of the longest bar that meets the goal, to a few thousandths; empty if none does.
std::optional<double> sufficient_length_m(const DesignGoal& goal, double crank_m) {
  double too_short = std::min(longest_bar_m(goal), kLongestUseful * crank_m);
  double enough = kLongestUseful * crank_m;
  if (!meets(best_with(goal, crank_m, enough), goal)) {
    return std::nullopt;
  }
  for (int k = 0; k < kLengthHalvings; ++k) {
    const double middle = std::sqrt(too_short * enough);
    (meets(best_with(goal, crank_m, middle), goal) ? enough : too_short) = middle;
  }
  return enough;
}

std::string cause_text(const DesignGoal& goal, double crank_m) {
  if (const std::optional<double> enough = sufficient_length_m(goal, crank_m)) {
    if (*enough > kMostBar_m) {
      return "a bar is at most 1 m long: allow a crank of " + number_text(100.0 * crank_m * kMostBar_m / *enough, 3) +
             " cm";
    }
    return "the bars are too short: allow a longest bar of " + number_text(100.0 * *enough, 3) +
           " cm (or as much shorter a crank)";
  }
  DesignGoal any_ratio = goal;
  any_ratio.time_ratio.reset();
  if (meets(best_with(any_ratio, crank_m, kLongestUseful * crank_m), any_ratio)) {
    return "the time ratio is too high for bars of any length: ask for less of it, or for less swing or transmission";
  }
  return "ask for less swing or less transmission";
}

[[noreturn]] void fail(const DesignGoal& goal, const std::optional<Reached>& best) {
  std::string message = "no crank-rocker with " + goal_text(goal) + ", a crank of at least " +
                        cm_text(goal.least_crank_m) + " cm and bars up to " + cm_text(longest_bar_m(goal)) + " cm";
  if (best) {
    message += " keeps its transmission angle at " + angle_text(goal.min_transmission_rad) + ": the best reaches " +
               angle_text(best->transmission_rad) + " (crank " + cm_text(best->bars.crank_m) + ", coupler " +
               cm_text(best->bars.coupler_m) + ", rocker " + cm_text(best->bars.rocker_m) + ", ground " +
               cm_text(best->bars.ground_m) + " cm)";
  } else {
    message += " exists";
  }
  throw ConfigError(message + "; " + cause_text(goal, goal.least_crank_m));
}

/// Scales the shape as far as the crank's range and the longest bar allow, because length errors matter less then.
FourBar as_large_as_allowed(const DesignGoal& goal, const FourBar& shape) {
  const double longest = std::max({shape.coupler_m, shape.rocker_m, shape.ground_m}) / shape.crank_m;
  const double crank_m = std::max(goal.least_crank_m, std::min(goal.most_crank_m, longest_bar_m(goal) / longest));
  const double scale = crank_m / shape.crank_m;
  return {.crank_m = crank_m,
          .coupler_m = scale * shape.coupler_m,
          .rocker_m = scale * shape.rocker_m,
          .ground_m = scale * shape.ground_m};
}

/// The best shape unchanged, and others that differ from it and from each other.
std::vector<FourBar> designed_bars(const DesignGoal& goal, const FourBar& best, std::size_t count) {
  if (count <= 1) return {best};
  const auto imbalance = goal.time_ratio ? std::optional(imbalance_of_time_ratio(*goal.time_ratio)) : std::nullopt;
  const ShapeLimits limits{
      .swing_rad = goal.swing_rad, .imbalance_rad = imbalance, .longest = longest_bar_m(goal) / goal.least_crank_m};
  std::vector<FourBar> all = spread_shapes(shapes_above(limits, goal.min_transmission_rad, best), count);
  std::transform(all.begin() + 1, all.end(), all.begin() + 1,
                 [&goal](const FourBar& shape) { return as_large_as_allowed(goal, shape); });
  return all;
}

}  // namespace

// A shorter crank in the same room transmits better, so the shortest crank decides whether the goal can be met.
std::vector<Design> design(const DesignGoal& goal, std::size_t count) {
  require_sound(goal);
  require_possible(goal);
  const std::optional<Reached> best = best_with(goal, goal.least_crank_m, longest_bar_m(goal));
  if (!meets(best, goal)) {
    fail(goal, best);
  }
  std::vector<Design> designs;
  for (const FourBar& bars : designed_bars(goal, best->bars, count)) {
    designs.push_back({.bars = bars, .report = analyse(bars, Assembly::kOpen)});
  }
  std::stable_sort(designs.begin(), designs.end(), [](const Design& a, const Design& b) {
    return a.report.least_transmission_rad > b.report.least_transmission_rad + kEqualAngle_rad;
  });
  return designs;
}

}  // namespace gdtslam::calib
