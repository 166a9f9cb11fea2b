#include "gauss_newton.hpp"

#include <cmath>
#include <optional>

namespace gdtslam {
namespace {

constexpr double kFirstDamping = 1.0e-4;
constexpr double kLeastDamping = 1.0e-7;
constexpr double kMostDamping = 1.0e6;

struct Step {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;
};

// (H + damping diag H) step = -gradient by Cholesky's factorisation; nothing where that is singular.
std::optional<Step> step_of(const Linearisation& at, double damping) {
  const auto& [xx, xy, xt, yy, yt, tt] = at.curvature;
  const double grow = 1.0 + damping;
  const double l00 = std::sqrt(xx * grow);
  if (!(l00 > 0.0)) return std::nullopt;
  const double l10 = xy / l00;
  const double l20 = xt / l00;
  const double l11_sq = yy * grow - l10 * l10;
  if (!(l11_sq > 0.0)) return std::nullopt;
  const double l11 = std::sqrt(l11_sq);
  const double l21 = (yt - l20 * l10) / l11;
  const double l22_sq = tt * grow - l20 * l20 - l21 * l21;
  if (!(l22_sq > 0.0)) return std::nullopt;
  const double l22 = std::sqrt(l22_sq);
  const double u0 = -at.gradient[0] / l00;
  const double u1 = (-at.gradient[1] - l10 * u0) / l11;
  const double u2 = (-at.gradient[2] - l20 * u0 - l21 * u1) / l22;
  const double theta = u2 / l22;
  const double y = (u1 - l21 * theta) / l11;
  return Step{(u0 - l10 * y - l20 * theta) / l00, y, theta};
}

CellPose moved(const CellPose& pose, const Step& step) {
  return {pose.x + static_cast<float>(step.x), pose.y + static_cast<float>(step.y),
          pose.theta + static_cast<float>(step.theta)};
}

}  // namespace

LocalMinimum minimise_gauss_newton(Objective& objective, const CellPose& start, const GaussNewtonOptions& options) {
  CellPose pose = start;
  Linearisation here = objective.linearise(pose, options.scale_cells);
  double damping = kFirstDamping;
  std::uint32_t evaluations = 1;
  StopReason stop = StopReason::kEvaluationLimit;
  while (evaluations < options.max_evaluations) {
    const std::optional<Step> step = step_of(here, damping);
    const bool is_small = step && std::abs(step->x) < static_cast<double>(options.stop_cells) &&
                          std::abs(step->y) < static_cast<double>(options.stop_cells) &&
                          std::abs(step->theta) < static_cast<double>(options.stop_rad);
    if (is_small || damping > kMostDamping) {
      stop = StopReason::kConverged;
      break;
    }
    if (!step) {
      damping *= 100.0;
      continue;
    }
    const CellPose next = moved(pose, *step);
    const Linearisation there = objective.linearise(next, options.scale_cells);
    ++evaluations;
    if (there.cost < here.cost) {
      pose = next;
      here = there;
      damping = std::max(damping * 0.1, kLeastDamping);
    } else {
      damping *= 10.0;
    }
  }
  return {pose, objective.evaluate(pose), evaluations + 1, stop};
}

}  // namespace gdtslam
