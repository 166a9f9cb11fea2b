#include "descents.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/optimize/minimise.hpp"

namespace gdtslam {
namespace {

/// The cost of a pose as a function of three numbers: offsets from the start as shares of the box's half widths, so
/// that the methods are independent of cells and radians.
class PoseFunction final : public optimize::Function {
 public:
  PoseFunction(Objective& objective, const CellPose& start, const PoseBox& box)
      : objective_(&objective), start_(start), box_(box) {}

  [[nodiscard]] std::size_t dimensions() const override { return 3; }

  void evaluate(std::span<const double> points, std::span<double> values) override {
    poses_.resize(values.size());
    costs_.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) poses_[i] = to_pose(points.subspan(3 * i, 3));
    objective_->evaluate(poses_, costs_);
    std::copy(costs_.begin(), costs_.end(), values.begin());
  }

  [[nodiscard]] CellPose to_pose(std::span<const double> offset) const {
    return {start_.x + static_cast<float>(offset[0]) * box_.half_cells,
            start_.y + static_cast<float>(offset[1]) * box_.half_cells,
            start_.theta + static_cast<float>(offset[2]) * box_.half_rad};
  }

 private:
  Objective* objective_;
  CellPose start_;
  PoseBox box_;
  std::vector<CellPose> poses_;
  std::vector<std::uint32_t> costs_;
};

optimize::Minimum run(PoseFunction& function, MatcherKind kind, double tolerance, const OptimizerConfig& options) {
  constexpr std::array kStart{0.0, 0.0, 0.0};
  const optimize::Box box{{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  const optimize::Limits limits{.max_evaluations = static_cast<std::uint64_t>(options.max_evaluations)};
  const auto seed = static_cast<std::uint64_t>(options.seed);
  if (kind == MatcherKind::kPso) {
    return minimise(function, box, kStart,
                    optimize::ParticleSwarm{
                        .particles = static_cast<std::size_t>(options.particles), .tolerance = tolerance, .seed = seed},
                    limits);
  }
  if (kind == MatcherKind::kSce) {
    return minimise(function, box, kStart,
                    optimize::ShuffledComplex{
                        .complexes = static_cast<std::size_t>(options.complexes), .tolerance = tolerance, .seed = seed},
                    limits);
  }
  return minimise(function, box, kStart,
                  optimize::SimplexAnnealing{.cooling = options.cooling,
                                             .moves_per_dimension = static_cast<std::uint32_t>(options.moves),
                                             .tolerance = tolerance,
                                             .seed = seed},
                  limits);
}

constexpr double kFirstDamping = 1.0e-4;
constexpr double kLeastDamping = 1.0e-7;
constexpr double kMostDamping = 1.0e6;

struct GaussStep {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;
};

// Solves (H + damping diag H) step = -gradient by Cholesky's factorisation; empty if the matrix is singular.
std::optional<GaussStep> damped_step(const Linearisation& at, double damping) {
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
  return GaussStep{(u0 - l10 * y - l20 * theta) / l00, y, theta};
}

CellPose moved(const CellPose& pose, const GaussStep& step) {
  return {pose.x + static_cast<float>(step.x), pose.y + static_cast<float>(step.y),
          pose.theta + static_cast<float>(step.theta)};
}

}  // namespace

LocalMinimum minimise_in_box(Objective& objective, const CellPose& start, const PoseBox& box, MatcherKind kind,
                             const OptimizerConfig& options) {
  PoseFunction function(objective, start, box);
  // relative to the whole width, twice the half width
  const float tolerance = 0.5F * std::min(box.stop_cells / box.half_cells, box.stop_rad / box.half_rad);
  const optimize::Minimum found = run(function, kind, static_cast<double>(tolerance), options);
  return {function.to_pose(found.point), static_cast<std::uint32_t>(found.value),
          static_cast<std::uint32_t>(found.evaluations),
          found.stop == optimize::Stop::kConverged ? StopReason::kConverged : StopReason::kEvaluationLimit};
}

LocalMinimum minimise_gauss_newton(Objective& objective, const CellPose& start, const GaussNewtonOptions& options) {
  CellPose pose = start;
  Linearisation here = objective.linearise(pose, options.scale_cells);
  double damping = kFirstDamping;
  std::uint32_t evaluations = 1;
  StopReason stop = StopReason::kEvaluationLimit;
  while (evaluations < options.max_evaluations) {
    const std::optional<GaussStep> step = damped_step(here, damping);
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

StopReason stop_reason(std::uint32_t stop) {
  return stop == 1 ? StopReason::kConverged : stop == 2 ? StopReason::kEvaluationLimit : StopReason::kNotRun;
}

LocalMinimum minimise_simplex(Objective& objective, const CellPose& start, const SimplexOptions& options) {
  const PolishedPose found = objective.descend(start, {.cost = objective.cost_params(),
                                                       .prior = objective.prior_params(),
                                                       .step_cells = options.step_cells,
                                                       .step_rad = options.step_rad,
                                                       .stop_cells = options.stop_cells,
                                                       .stop_rad = options.stop_rad,
                                                       .max_evaluations = options.max_evaluations});
  return {.pose = {found.x, found.y, found.theta},
          .cost = found.cost,
          .evaluations = found.evaluations,
          .stop = stop_reason(found.stop)};
}

}  // namespace gdtslam
