#include "joint_adjustment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/mapping/adjust/pose_bins.hpp"

namespace gdtslam {
namespace {

constexpr double kHardly_m = 0.001;  // motion of a pair within which its lines are kept
constexpr double kHardly_rad = 0.0004;
constexpr double kFewestLaid = 15.0;  // points needed to match a scan with another

// The core has these pairs of each keyframe: the next ones back in time, and the nearest ones of earlier passes.
constexpr std::size_t kCoreBack = 3;
constexpr std::size_t kCoreNear = 2;

/// Information of a match between two scans, without what tilted normals feign. At a surface that ends behind another,
/// normals are off by some degrees, always to the same side: along a bare corridor that pulls scans onto each other, by
/// half a per cent of the way.
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

std::vector<KeyframePair> find_pairs(const std::vector<Pose2>& poses, const PairRules& rules) {
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

JointAdjustment::JointAdjustment(const std::vector<LineScan>& scans, std::vector<PoseRelation> held,
                                 const JointOptions& options)
    : scans_(scans), held_(std::move(held)), options_(options) {}

/// The equations of a scan on the lines of another, where they were built last.
struct JointAdjustment::Built {
  Pose2 T_fixed_moving;
  double gate_m = 0.0;  ///< 0: not built yet
  double weight = 0.0;
  double cost_m2 = 0.0;
  Belief belief;
};

// The equations of all pairs, and of a core of them. A place that was passed often has dozens of keyframes beside each
// other, so a factor of the whole would grow with the square of the passes. The core has few pairs a keyframe and a
// small factor, and resembles the whole so well that some thirty conjugate gradients solve it.
class JointAdjustment::Systems {
 public:
  Systems(std::vector<KeyframePair> pairs, const std::vector<PoseRelation>& held, std::size_t keyframes)
      : pairs_(std::move(pairs)), whole_(make_system(pairs_, held, keyframes)) {
    choose_core();
    std::vector<KeyframePair> core;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (is_of_core_[i]) core.push_back(pairs_[i]);
    }
    core_.emplace(make_system(core, held, keyframes));
    factor_.emplace(*core_);
    both_ = {&whole_, &*core_};
    built_.resize(pairs_.size());
  }
  Systems(const Systems&) = delete;
  Systems& operator=(const Systems&) = delete;

  [[nodiscard]] const std::vector<KeyframePair>& pairs() const { return pairs_; }
  /// Empties the systems of a step; the core's factor is made once for each gate.
  void begin(double gate_m) {
    is_core_new_ = std::exchange(core_gate_m_, gate_m) != gate_m;
    for (BlockSystem* system : all()) system->clear();
  }
  /// Systems of this step that contain a pair.
  [[nodiscard]] std::span<BlockSystem* const> of_pair(std::size_t pair) const {
    return is_of_core_[pair] ? all() : all().first(1);
  }
  /// The equations of a pair, to its earlier keyframe and back.
  [[nodiscard]] std::array<Built, 2>& built(std::size_t pair) { return built_[pair]; }
  [[nodiscard]] std::span<BlockSystem* const> all() const { return std::span(both_).first(is_core_new_ ? 2 : 1); }
  /// Moves the poses by the solution, see take_step_by_core().
  double step(std::vector<Pose2>& poses) {
    if (is_core_new_ && !factorise_core(*core_, *factor_)) return -1.0;
    return take_step_by_core(whole_, *factor_, poses);
  }

 private:
  static BlockSystem make_system(const std::vector<KeyframePair>& pairs, const std::vector<PoseRelation>& held,
                                 std::size_t keyframes) {
    std::vector<BlockSystem::Pair> pattern(pairs.begin(), pairs.end());
    for (const PoseRelation& relation : held) pattern.emplace_back(relation.from, relation.to);
    return {keyframes, std::move(pattern)};
  }

  // The pairs of a keyframe are consecutive; those in space come nearest first.
  void choose_core() {
    const std::size_t longest = PairRules{}.back.back();
    std::size_t near = 0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [from, to] = pairs_[i];
      if (i == 0 || pairs_[i - 1].second != to) near = 0;
      is_of_core_.push_back(to - from <= kCoreBack || (to - from > longest && near++ < kCoreNear));
    }
  }

  std::vector<KeyframePair> pairs_;
  std::vector<bool> is_of_core_;
  BlockSystem whole_;
  std::optional<BlockSystem> core_;
  std::optional<BlockCholesky> factor_;  // factor of the core's equations
  std::array<BlockSystem*, 2> both_{};
  std::vector<std::array<Built, 2>> built_;
  double core_gate_m_ = 0.0;  // gate of the core's factor
  bool is_core_new_ = false;
};

/// Contribution of one scan matched with another to the equations.
struct JointAdjustment::OneWay {
  bool is_laid = false;
  Matrix3 of_moving;
  Matrix3 of_fixed;
  Matrix3 cross;  ///< (moving, fixed)
  Tangent2 pull_on_moving{};
  Tangent2 pull_on_fixed{};
  double weight = 0.0;
  double cost_m2 = 0.0;

  void add_to(BlockSystem& system, std::size_t fixed, std::size_t moving) const {
    system.diagonal[moving] += of_moving;
    system.diagonal[fixed] += of_fixed;
    system.add(moving, fixed, cross);
    subtract(system.right[moving], pull_on_moving);
    subtract(system.right[fixed], pull_on_fixed);
  }
};

namespace {

/// Whether a pair moved so far since its equations were built that they are wanted anew; where it is now.
void want(std::size_t fixed, std::size_t moving, const std::vector<Pose2>& poses, bool is_built, const Pose2& built_at,
          LinePair& way) {
  way.fixed = fixed;
  way.moving = moving;
  way.found_at = way.at = between(poses[fixed], poses[moving]);
  const Tangent2 moved = log_tangent(between(built_at, way.at));
  way.is_wanted =
      !is_built || std::max(std::fabs(moved[0]), std::fabs(moved[1])) > kHardly_m || std::fabs(moved[2]) > kHardly_rad;
}

}  // namespace

// Motions of the moving scan are tangents on its right; a motion of the fixed scan is, seen from the moving one, the
// opposite motion carried over.
JointAdjustment::OneWay JointAdjustment::one_way(const LinePair& way, double gate_m, Built& built) const {
  Tangent2 moved{};
  if (way.is_wanted) {
    const LineEquations& lines = way.equations;
    built = {way.at, gate_m, lines.weight, lines.cost_m2, lines.weight < kFewestLaid ? Belief{} : belief_in(lines)};
  } else {
    moved = log_tangent(between(built.T_fixed_moving, way.at));
  }
  if (built.weight < kFewestLaid) return {};
  const double weight = options_.independent / (options_.point_noise_m * options_.point_noise_m);
  const Matrix3 by_fixed = -1.0 * adjoint_matrix(inverse(way.at));
  const Matrix3 information = weight * built.belief.information;
  const Matrix3 cross = information * by_fixed;
  Tangent2 pull = information * moved;
  for (std::size_t k = 0; k < pull.size(); ++k) pull[k] += weight * built.belief.gradient[k];
  return {.is_laid = true,
          .of_moving = information,
          .of_fixed = transposed_times(by_fixed, cross),
          .cross = cross,
          .pull_on_moving = pull,
          .pull_on_fixed = transposed(by_fixed) * pull,
          .weight = built.weight,
          .cost_m2 = built.cost_m2};
}

// Workers or a device match the scans; one thread adds up the results, in the order of the pairs.
LineEquations JointAdjustment::lay_pairs(const LineGate& gate, Systems& systems, const std::vector<Pose2>& poses,
                                         WorkerPool& workers, LinePairs& lines) const {
  const std::vector<KeyframePair>& pairs = systems.pairs();
  std::vector<std::array<OneWay, 2>> laid(std::min(lines.at_once() / 2, pairs.size()));
  std::vector<LinePair> ways(2 * laid.size());
  LineEquations total;
  for (std::size_t first = 0; first < pairs.size(); first += laid.size()) {
    const std::size_t count = std::min(laid.size(), pairs.size() - first);
    workers.run(count, 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto& [from, to] = pairs[first + k];
        const auto& [there, back] = systems.built(first + k);
        want(from, to, poses, there.gate_m == gate.most_m, there.T_fixed_moving, ways[2 * k]);
        want(to, from, poses, back.gate_m == gate.most_m, back.T_fixed_moving, ways[2 * k + 1]);
      }
    });
    lines.build(scans_, gate, std::span(ways).first(2 * count));
    workers.run(count, 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        auto& [there, back] = systems.built(first + k);
        laid[k] = {one_way(ways[2 * k], gate.most_m, there), one_way(ways[2 * k + 1], gate.most_m, back)};
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [from, to] = pairs[first + k];
      for (const OneWay& way : laid[k]) {
        if (!way.is_laid) continue;
        const bool is_forward = &way == laid[k].data();
        for (BlockSystem* system : systems.of_pair(first + k)) {
          way.add_to(*system, is_forward ? from : to, is_forward ? to : from);
        }
        total.weight += way.weight;
        total.cost_m2 += way.cost_m2;
      }
    }
  }
  return total;
}

double JointAdjustment::take_step(double gate_m, Systems& systems, std::vector<Pose2>& poses, WorkerPool& workers,
                                  LinePairs& lines, JointResult& result) const {
  systems.begin(gate_m);
  const LineGate gate{.most_m = gate_m, .points = options_.points};
  const LineEquations total = lay_pairs(gate, systems, poses, workers, lines);
  for (BlockSystem* system : systems.all()) {
    for (const PoseRelation& relation : held_) add_relation(relation, poses, 1.0, *system);
  }
  result.rms_m = total.weight > 0.0 ? std::sqrt(total.cost_m2 / total.weight) : 0.0;
  result.pairs = systems.pairs().size();
  return systems.step(poses);
}

JointResult JointAdjustment::run(std::vector<Pose2>& poses, WorkerPool& workers, const Progress& progress,
                                 const BatchDevice& device) const {
  JointResult result;
  if (poses.size() < 2) return result;
  Systems systems(find_pairs(poses), held_, scans_.size());
  LinePairs lines(scans_, workers, device);
  double gate_m = options_.first_gate_m;
  for (int step = 0; step < options_.iterations; ++step) {
    result.largest_step_m = take_step(gate_m, systems, poses, workers, lines, result);
    if (result.largest_step_m < options_.still_m && gate_m <= options_.last_gate_m) break;
    gate_m = std::max(options_.last_gate_m, options_.narrowing * gate_m);
    progress(static_cast<double>(step + 1) / static_cast<double>(options_.iterations));
  }
  return result;
}

}  // namespace gdtslam
