#include "box_search.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "gdtslam/optimize/minimise.hpp"

namespace gdtslam {
namespace {

/// The cost of a pose as a function of three numbers: offsets from the start as shares of the box's half widths, so
/// that the methods need to know nothing of cells and radians.
class PoseFunction final : public optimize::Function {
 public:
  PoseFunction(Objective& objective, const CellPose& start, const PoseBox& box)
      : objective_(&objective), start_(start), box_(box) {}

  [[nodiscard]] std::size_t dimensions() const override { return 3; }

  void evaluate(std::span<const double> points, std::span<double> values) override {
    poses_.resize(values.size());
    costs_.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) poses_[i] = pose_of(points.subspan(3 * i, 3));
    objective_->evaluate(poses_, costs_);
    std::copy(costs_.begin(), costs_.end(), values.begin());
  }

  [[nodiscard]] CellPose pose_of(std::span<const double> offset) const {
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
  // Of the whole width, which is twice the half width.
  const float tolerance = 0.5F * std::min(box.stop_cells / box.half_cells, box.stop_rad / box.half_rad);
  const optimize::Minimum found = run(function, kind, static_cast<double>(tolerance), options);
  return {function.pose_of(found.point), static_cast<std::uint32_t>(found.value),
          static_cast<std::uint32_t>(found.evaluations),
          found.stop == optimize::Stop::kConverged ? StopReason::kConverged : StopReason::kEvaluationLimit};
}

}  // namespace gdtslam
