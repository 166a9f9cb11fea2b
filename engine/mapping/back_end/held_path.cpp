#include "held_path.hpp"

#include <algorithm>
#include <iterator>

namespace gdtslam {
namespace {

// In the joint adjustment the points themselves give most information: the path constrains weakly, through the front
// end's relations over stretches of its local map.
constexpr double kChainShare = 0.05;
constexpr double kWheelShare = 0.3;
constexpr std::size_t kSpans[] = {4, 12, 30};  // keyframes
constexpr std::size_t kSpansOver = 4;          // spans of each length over a step, which is to count once
constexpr double kSpanNoise_m = 0.01;
constexpr double kSpanNoise_rad = 0.003;

PoseRelation held(std::size_t from, std::size_t to, const PoseRelation& relation, double share) {
  return {.from = from, .to = to, .T_from_to = relation.T_from_to, .information = share * relation.information};
}

}  // namespace

std::optional<std::size_t> number_in(std::span<const std::size_t> kept, std::size_t keyframe) {
  const auto found = std::lower_bound(kept.begin(), kept.end(), keyframe);
  if (found == kept.end() || *found != keyframe) return std::nullopt;
  return static_cast<std::size_t>(found - kept.begin());
}

std::vector<PoseRelation> held_path(const MeasuredPath& measured, std::span<const std::size_t> kept) {
  std::vector<PoseRelation> path;
  for (std::size_t i = 1; i < kept.size(); ++i) {
    path.push_back(held(i - 1, i, measured.stretch(kept[i - 1], kept[i], StepSource::kWheels), kWheelShare));
    path.push_back(held(i - 1, i, measured.stretch(kept[i - 1], kept[i], StepSource::kFrontEnd), kChainShare));
  }
  const Matrix3 floor = Matrix3::diagonal(square(kSpanNoise_m), square(kSpanNoise_m), square(kSpanNoise_rad));
  for (const std::size_t span : kSpans) {
    for (std::size_t i = 0; i + span < kept.size(); i += span / kSpansOver) {
      if (kept[i + span] - kept[i] != span) continue;  // some keyframes in between are not kept
      PoseRelation stretch = measured.stretch(kept[i], kept[i + span], StepSource::kFrontEnd);
      stretch.information = inverse(inverse(stretch.information) + floor);
      path.push_back(held(i, i + span, stretch, 1.0 / static_cast<double>(kSpansOver * std::size(kSpans))));
    }
  }
  return path;
}

std::vector<PoseRelation> held_loops(const PoseGraph& graph, std::span<const std::size_t> places,
                                     std::span<const std::size_t> kept) {
  std::vector<PoseRelation> loops;
  for (const Loop& loop : graph.loops) {
    const std::optional<std::size_t> from = number_in(kept, places[loop.relation.from]);
    const std::optional<std::size_t> to = number_in(kept, places[loop.relation.to]);
    if (loop.is_on() && from && to) loops.push_back(held(*from, *to, loop.relation, loop.weight));
  }
  return loops;
}

}  // namespace gdtslam
