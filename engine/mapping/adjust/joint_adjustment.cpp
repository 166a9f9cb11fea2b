#include "joint_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/mapping/adjust/pose_bins.hpp"

namespace gdtslam {
namespace {

constexpr double kFewestLaid = 15.0;  // that lay a scan on another

/// What scans tell of each other, less what tilted normals feign. Where a surface ends behind another, normals are off
/// by some degrees, always to the same side: along a corridor without much else that pulls scans onto each other, half
/// a per cent of the way.
struct Belief {
  Matrix3 information;
  Tangent2 gradient{};
};

Belief belief_in(const LineEquations& lines) {
  const Eigen3 eigen = eigen_of_symmetric(1.0 / lines.weight * lines.information);
  const auto believed = [](double value) { return std::max(0.0, value - kShapeOfTiltedNormals); };
  const Matrix3 share =
      with_eigenvalues(eigen, [&](double value) { return value > 0.0 ? believed(value) / value : 0.0; });
  return {lines.weight * with_eigenvalues(eigen, believed), share * lines.gradient};
}

}  // namespace

std::vector<KeyframePair> pairs_of(const std::vector<Pose2>& poses, const PairRules& rules) {
  std::vector<KeyframePair> pairs;
  PoseBins bins(rules.near_m);
  const std::size_t longest = rules.back.empty() ? 0 : rules.back.back();
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const std::size_t back : rules.back) {
      if (i >= back) pairs.emplace_back(i - back, i);
    }
    near.clear();
    bins.visit_near(poses[i], [&](std::size_t j) {
      const double away_m2 = squared_distance(poses[i], poses[j]);
      if (away_m2 < square(rules.near_m)) near.emplace_back(away_m2, j);
    });
    const std::size_t count = std::min(near.size(), rules.most_near);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t k = 0; k < count; ++k) pairs.emplace_back(near[k].second, i);
    if (i >= longest) bins.add(i - longest, poses[i - longest]);
  }
  return pairs;
}

JointAdjustment::JointAdjustment(const std::vector<KeptScan>& scans, std::vector<PoseRelation> held,
                                 const JointOptions& options)
    : scans_(scans), held_(std::move(held)), options_(options) {}

BlockSystem JointAdjustment::system_for(const std::vector<KeyframePair>& pairs) const {
  std::vector<BlockSystem::Pair> pattern(pairs.begin(), pairs.end());
  for (const PoseRelation& relation : held_) pattern.emplace_back(relation.from, relation.to);
  return {scans_.size(), std::move(pattern)};
}

// Motions of the scan that moves are tangents on its right; one of the scan that stands still is, seen from the moving
// one, the opposite motion carried over.
void JointAdjustment::add_one_way(std::size_t fixed, std::size_t moving, const std::vector<Pose2>& poses,
                                  const LineGate& gate, BlockSystem& system, LineEquations& total) const {
  const Pose2 T_fixed_moving = between(poses[fixed], poses[moving]);
  const LineEquations lines = line_equations(scans_[fixed], scans_[moving], T_fixed_moving, gate);
  if (lines.weight < kFewestLaid) return;
  const double weight = options_.independent / (options_.point_noise_m * options_.point_noise_m);
  const Matrix3 by_fixed = -1.0 * adjoint_matrix(inverse(T_fixed_moving));
  const Belief belief = belief_in(lines);
  const Matrix3 information = weight * belief.information;
  const Matrix3 cross = information * by_fixed;  // (moving, fixed)
  system.diagonal[moving] += information;
  system.diagonal[fixed] += transposed_times(by_fixed, cross);
  system.add(moving, fixed, cross);
  const Tangent2 pull{weight * belief.gradient[0], weight * belief.gradient[1], weight * belief.gradient[2]};
  subtract(system.right[moving], pull);
  subtract(system.right[fixed], transposed(by_fixed) * pull);
  total.weight += lines.weight;
  total.cost_m2 += lines.cost_m2;
}

void JointAdjustment::add_pair(const KeyframePair& pair, const std::vector<Pose2>& poses, const LineGate& gate,
                               BlockSystem& system, LineEquations& total) const {
  add_one_way(pair.first, pair.second, poses, gate, system, total);
  add_one_way(pair.second, pair.first, poses, gate, system, total);
}

JointResult JointAdjustment::run(std::vector<Pose2>& poses, const Progress& progress) const {
  JointResult result;
  if (poses.size() < 2) return result;
  std::vector<KeyframePair> pairs;
  std::optional<BlockSystem> system;
  std::optional<BlockCholesky> factor;
  double gate_m = options_.first_gate_m;
  for (int step = 0; step < options_.iterations; ++step) {
    const bool has_new_pairs = step % options_.pairs_every == 0;
    if (has_new_pairs) {
      pairs = pairs_of(poses);
      system.emplace(system_for(pairs));
      factor.emplace(*system);
    }
    system->clear();
    LineEquations total;
    const LineGate gate{.most_m = gate_m, .points = options_.points};
    for (const KeyframePair& pair : pairs) add_pair(pair, poses, gate, *system, total);
    for (const PoseRelation& relation : held_) add_relation(relation, poses, 1.0, *system);
    result.largest_step_m =
        has_new_pairs ? take_step(*system, *factor, poses) : take_step_near(*system, *factor, poses);
    result.rms_m = total.weight > 0.0 ? std::sqrt(total.cost_m2 / total.weight) : 0.0;
    result.pairs = pairs.size();
    const bool is_still = result.largest_step_m < options_.still_m && gate_m <= options_.last_gate_m;
    if (is_still && step >= options_.pairs_every) break;
    gate_m = std::max(options_.last_gate_m, options_.narrowing * gate_m);
    progress(static_cast<double>(step + 1) / static_cast<double>(options_.iterations));
  }
  return result;
}

}  // namespace gdtslam
