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

LocalMinimum minimise_along_slope(Objective& objective, const CellPose& start, const PoseDescent::Params& descent) {
  std::vector<PolishedPose> found{{start.x, start.y, start.theta}};
  std::vector<std::uint16_t> values(PoseDescent::row_of(static_cast<std::uint32_t>(objective.points().size())));
  objective.descend(descent, found, values);
  const CellPose end{found.front().x, found.front().y, found.front().theta};
  return {end, objective.evaluate(end), found.front().evaluations + 1, stop_reason(found.front().stop)};
}

}  // namespace gdtslam
