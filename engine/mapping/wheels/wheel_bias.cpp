#include "wheel_bias.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr int kRounds = 5;        // rounds of weighing by residuals
constexpr double kFreedom = 4.0;  // degrees of freedom of Student's t
constexpr double kOneSigma = 0.683;
constexpr double kLeastNoise = 1.0e-4;  // least noise of a residual over the root of its length
constexpr double kStandingOut = 3.0;    // standard deviations
constexpr WheelBias kNothingKnown;

/// An equation of a stretch; its residual grows as the root of the stretch's length.
struct Equation {
  double a = 0.0;  // factor of the first unknown; b: of the second
  double b = 0.0;
  double missing = 0.0;
  double length = 0.0;
};

struct Solution {
  double a = 0.0;
  double b = 0.0;
  double sigma_a = 0.0;
  double sigma_b = 0.0;
};

// One standard deviation of the residuals, for a length of one.
double residual_spread(const std::vector<Equation>& equations, const Solution& solution) {
  std::vector<double> off;
  off.reserve(equations.size());
  for (const Equation& e : equations) {
    off.push_back(std::fabs(e.missing - solution.a * e.a - solution.b * e.b) / std::sqrt(e.length));
  }
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(kOneSigma * static_cast<double>(off.size() - 1));
  std::nth_element(off.begin(), middle, off.end());
  return std::max(kLeastNoise, *middle);
}

Solution solve(const std::vector<Equation>& equations, double prior_a, double prior_b, double overlap) {
  Solution solution{0.0, 0.0, prior_a, prior_b};
  if (equations.empty()) return solution;
  for (int round = 0; round < kRounds; ++round) {
    const double variance = square(residual_spread(equations, solution));
    double aa = 1.0 / square(prior_a);
    double bb = 1.0 / square(prior_b);
    double ab = 0.0, ay = 0.0, by = 0.0;
    for (const Equation& e : equations) {
      const double of_length = variance * e.length;
      const double off = square(e.missing - solution.a * e.a - solution.b * e.b) / of_length;
      const double weight = (kFreedom + 1.0) / (kFreedom + off) / (of_length * overlap);
      aa += weight * e.a * e.a;
      bb += weight * e.b * e.b;
      ab += weight * e.a * e.b;
      ay += weight * e.a * e.missing;
      by += weight * e.b * e.missing;
    }
    const double determinant = aa * bb - ab * ab;
    solution = {.a = (bb * ay - ab * by) / determinant,
                .b = (aa * by - ab * ay) / determinant,
                .sigma_a = std::sqrt(bb / determinant),
                .sigma_b = std::sqrt(aa / determinant)};
  }
  return solution;
}

// Part of a value that exceeds its noise.
double standing_out(double value, double noise) {
  return std::fabs(value) <= noise ? 0.0 : value * (1.0 - square(noise / value));
}

}  // namespace

WheelBias estimate_bias(std::span<const WheelStretch> stretches, double overlap) {
  std::vector<Equation> turns;
  for (const WheelStretch& s : stretches) {
    const double walk = heading_walk(s.path_m, s.turned_rad);
    // The true turn is known up to whole turns, which the wheels give.
    const double missing_rad = wrap_angle(s.true_turn_rad - s.turn_rad);
    if (walk > 0.0) turns.push_back({s.turn_rad + missing_rad, s.forward_m, missing_rad, walk});
  }
  const Solution turn = solve(turns, kNothingKnown.sigma_turn, kNothingKnown.sigma_rad_per_m, overlap);
  return {.turn = turn.a / (1.0 - turn.a),
          .turn_rad_per_m = turn.b,
          .sigma_turn = turn.sigma_a,
          .sigma_rad_per_m = turn.sigma_b};
}

double distance_added(const WheelBias& bias) { return standing_out(bias.distance, kStandingOut * bias.sigma_distance); }

Pose2 corrected(const Pose2& by_wheels, const WheelBias& bias) {
  const Tangent2 t = log_tangent(by_wheels);
  const double longer = 1.0 + distance_added(bias);
  const double turn = (1.0 + standing_out(bias.turn, kStandingOut * bias.sigma_turn)) * t[2] +
                      standing_out(bias.turn_rad_per_m, kStandingOut * bias.sigma_rad_per_m) * t[0];
  return exp_tangent({longer * t[0], longer * t[1], turn});
}

}  // namespace gdtslam
