#include "graph_replay.hpp"

#include <algorithm>
#include <map>

namespace gdtslam {
namespace {

/// Measured steps from place to place, and their information from all measurements.
struct ReplaySteps {
  std::vector<Pose2> T_place_next;
  std::vector<Matrix3> information;
};

ReplaySteps replay_steps(const PoseGraph& graph) {
  const std::size_t count = graph.poses.size() - 1;
  ReplaySteps steps{std::vector<Pose2>(count), std::vector<Matrix3>(count)};
  std::vector<bool> is_known(count, false);
  for (const PoseRelation& relation : graph.path) {
    if (relation.to != relation.from + 1) continue;
    if (!is_known[relation.from]) steps.T_place_next[relation.from] = relation.T_from_to;
    is_known[relation.from] = true;
    steps.information[relation.from] += relation.information;
  }
  return steps;
}

void drive_on_from(std::vector<Pose2>& poses, std::size_t place, const ReplaySteps& steps) {
  for (std::size_t i = place; i + 1 < poses.size(); ++i) poses[i + 1] = poses[i] * steps.T_place_next[i];
}

/// The part of the graph up to a place.
PoseGraph driven_part(const PoseGraph& graph, const std::vector<Pose2>& poses, std::size_t place) {
  PoseGraph part;
  part.poses.assign(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(place) + 1);
  const auto is_driven = [place](const PoseRelation& relation) {
    return std::max(relation.from, relation.to) <= place;
  };
  std::copy_if(graph.path.begin(), graph.path.end(), std::back_inserter(part.path), is_driven);
  std::copy_if(graph.loops.begin(), graph.loops.end(), std::back_inserter(part.loops),
               [&](const Loop& loop) { return is_driven(loop.relation); });
  return part;
}

/// Adds each step's own covariance to the covariance carried so far: perturbations act on the right.
std::vector<Matrix3> grown(const Matrix3& covariance, std::size_t from, std::size_t to, const ReplaySteps& steps) {
  std::vector<Matrix3> all{covariance};
  all.reserve(to - from + 1);
  for (std::size_t i = from; i < to; ++i) {
    const Matrix3 carried = adjoint_matrix(inverse(steps.T_place_next[i]));
    all.push_back(carried * times_transposed(all.back(), carried) + inverse(steps.information[i]));
  }
  return all;
}

/// Groups loops by their later place, and neighbouring places if there are too many; a group has its last place.
std::vector<ReplayStage> grouped_by_place(const std::vector<Loop>& loops, std::size_t most_stages) {
  std::map<std::size_t, std::vector<std::size_t>> by_place;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    by_place[std::max(loops[i].relation.from, loops[i].relation.to)].push_back(i);
  }
  const std::size_t most = std::max<std::size_t>(most_stages, 1);
  const std::size_t group = std::max<std::size_t>((by_place.size() + most - 1) / most, 1);
  std::vector<ReplayStage> stages(1);
  std::size_t count = 0;
  for (const auto& [place, indices] : by_place) {
    if (count++ % group == 0) stages.emplace_back();
    ReplayStage& stage = stages.back();
    stage.place = place;
    stage.loops.insert(stage.loops.end(), indices.begin(), indices.end());
  }
  return stages;
}

}  // namespace

std::vector<ReplayStage> replay_graph(const PoseGraph& graph, std::size_t most_stages) {
  if (graph.poses.empty()) return {};
  const ReplaySteps steps = replay_steps(graph);
  std::vector<ReplayStage> stages = grouped_by_place(graph.loops, most_stages);
  std::vector<Pose2> poses = graph.poses;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    ReplayStage& stage = stages[k];
    Matrix3 covariance{};
    if (k > 0) {
      PoseGraph part = driven_part(graph, poses, stage.place);
      part.settle();
      std::copy(part.poses.begin(), part.poses.end(), poses.begin());
      if (stage.place > 0) covariance = GraphCovariance(part).relative(0, stage.place);
    }
    drive_on_from(poses, stage.place, steps);
    stage.poses = poses;
    const std::size_t end = k + 1 < stages.size() ? stages[k + 1].place : poses.size() - 1;
    stage.covariances = grown(covariance, stage.place, end, steps);
  }
  return stages;
}

}  // namespace gdtslam
