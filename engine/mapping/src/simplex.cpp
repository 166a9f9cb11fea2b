#include "gdtslam/mapping/simplex.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gdtslam {
namespace {

struct Vertex {
  CellPose pose;
  std::uint32_t cost = 0;
};
using Simplex = std::array<Vertex, 4>;

// Coefficients of [Nelder1965]: reflection 1, expansion 2, contraction and shrinkage 1/2.
constexpr float kReflect = 1.0F;
constexpr float kExpand = 2.0F;
constexpr float kContract = 0.5F;
constexpr float kShrink = 0.5F;

CellPose along(const CellPose& from, const CellPose& to, float factor) {
  return {from.x + factor * (to.x - from.x), from.y + factor * (to.y - from.y),
          from.theta + factor * (to.theta - from.theta)};
}

CellPose centroid_of_best(const Simplex& s) {
  constexpr float kThird = 1.0F / 3.0F;
  return {(s[0].pose.x + s[1].pose.x + s[2].pose.x) * kThird, (s[0].pose.y + s[1].pose.y + s[2].pose.y) * kThird,
          (s[0].pose.theta + s[1].pose.theta + s[2].pose.theta) * kThird};
}

bool small_enough(const Simplex& s, const SimplexOptions& options) {
  float xy = 0.0F;
  float theta = 0.0F;
  for (std::size_t i = 1; i < s.size(); ++i) {
    xy = std::max({xy, std::fabs(s[i].pose.x - s[0].pose.x), std::fabs(s[i].pose.y - s[0].pose.y)});
    theta = std::max(theta, std::fabs(s[i].pose.theta - s[0].pose.theta));
  }
  return xy < options.stop_cells && theta < options.stop_rad;
}

// Stable, so that equal costs keep their order and every host walks the same way.
void sort_by_cost(Simplex& s) {
  std::stable_sort(s.begin(), s.end(), [](const Vertex& a, const Vertex& b) { return a.cost < b.cost; });
}

// One move of the worst vertex; false when the simplex must shrink.
bool move_worst(Objective& objective, Simplex& s) {
  Vertex& worst = s[3];
  const CellPose centre = centroid_of_best(s);
  const auto at = [&](float factor) {
    const CellPose pose = along(centre, worst.pose, factor);
    return Vertex{pose, objective.evaluate(pose)};
  };
  const Vertex reflected = at(-kReflect);
  if (reflected.cost < s[0].cost) {
    const Vertex expanded = at(-kExpand);
    worst = expanded.cost < reflected.cost ? expanded : reflected;
    return true;
  }
  if (reflected.cost < s[2].cost) {
    worst = reflected;
    return true;
  }
  const Vertex contracted = reflected.cost < worst.cost ? at(-kContract) : at(kContract);
  if (contracted.cost >= std::min(reflected.cost, worst.cost)) return false;
  worst = contracted;
  return true;
}

void shrink(Objective& objective, Simplex& s) {
  for (std::size_t i = 1; i < s.size(); ++i) {
    s[i].pose = along(s[0].pose, s[i].pose, kShrink);
    s[i].cost = objective.evaluate(s[i].pose);
  }
}

}  // namespace

SimplexResult minimise_simplex(Objective& objective, const CellPose& start, const SimplexOptions& options) {
  const std::uint64_t before = objective.evaluations();
  const auto used = [&] { return static_cast<std::uint32_t>(objective.evaluations() - before); };
  const std::array<CellPose, 4> poses{start,
                                      {start.x + options.step_cells, start.y, start.theta},
                                      {start.x, start.y + options.step_cells, start.theta},
                                      {start.x, start.y, start.theta + options.step_rad}};
  std::array<std::uint32_t, 4> costs{};
  objective.evaluate(poses, costs);
  Simplex s;
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = {poses[i], costs[i]};
  sort_by_cost(s);

  StopReason stop = StopReason::kConverged;
  while (!small_enough(s, options)) {
    if (used() >= options.max_evaluations) {
      stop = StopReason::kEvaluationLimit;
      break;
    }
    if (!move_worst(objective, s)) shrink(objective, s);
    sort_by_cost(s);
  }
  return {.pose = s[0].pose, .cost = s[0].cost, .evaluations = used(), .stop = stop};
}

}  // namespace gdtslam
