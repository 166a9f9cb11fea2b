#include "pose_graph.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "engine/core/memory/sparing.hpp"

namespace gdtslam {
namespace {

constexpr double kHeld = 1.0e12;       // information of the first pose: enough to fix it
constexpr double kStill_m = 1.0e-5;    // if no pose moves farther, the step is the last
constexpr double kNarrowing = 1.6;     // factor of the kernel's scale from step to step
constexpr double kWidest = 1.0e6;      // in units of its final scale
constexpr double kSlightlyWide = 4.0;  // kernel scale for a graph that changed by little
constexpr int kMostSteps = 100;
constexpr double kFarWorse = 100.0;  // factor of the cost: a right solution with other loops may cost somewhat more
constexpr int kMostHalvings = 12;    // limit for a step that makes things worse
constexpr double kUnsolved = 1.0e6;  // variance reported if a graph has no solution

BlockSystem system_for(const PoseGraph& graph) {
  std::vector<BlockSystem::Pair> pairs;
  for (const PoseRelation& relation : graph.path) pairs.emplace_back(relation.from, relation.to);
  for (const Loop& loop : graph.loops) pairs.emplace_back(loop.relation.from, loop.relation.to);
  if (graph.wheels.empty()) return {graph.poses.size(), std::move(pairs)};
  const std::size_t bias = graph.poses.size();  // the row behind the poses
  for (const auto& [relation, by_bias] : graph.wheels) {
    pairs.emplace_back(relation.from, relation.to);
    pairs.emplace_back(relation.from, bias);
    pairs.emplace_back(relation.to, bias);
  }
  return {bias + 1, std::move(pairs)};
}

Tangent2 residual_of_wheels(const WheelRelation& wheels, const PoseGraph& graph) {
  const PoseRelation& relation = wheels.relation;
  Tangent2 residual = relation_residual(relation, graph.poses[relation.from], graph.poses[relation.to]);
  subtract(residual, wheels.by_bias * graph.bias);
  return residual;
}

void add_wheels(const WheelRelation& wheels, const PoseGraph& graph, BlockSystem& system) {
  const auto& [from, to, T, information] = wheels.relation;
  const std::size_t bias = graph.poses.size();
  const Tangent2 residual = residual_of_wheels(wheels, graph);
  const Matrix3 by_from = -1.0 * adjoint_matrix(between(graph.poses[to], graph.poses[from]));
  const Matrix3 by_bias = -1.0 * wheels.by_bias;
  const Matrix3 of_from = information * by_from;
  const Matrix3 of_bias = information * by_bias;
  system.diagonal[to] += information;
  system.diagonal[from] += transposed_times(by_from, of_from);
  system.diagonal[bias] += transposed_times(by_bias, of_bias);
  system.add(to, from, of_from);
  system.add(to, bias, of_bias);
  system.add(from, bias, transposed_times(by_from, of_bias));
  const Tangent2 pull = information * residual;
  subtract(system.right[to], pull);
  subtract(system.right[from], transposed(by_from) * pull);
  subtract(system.right[bias], transposed(by_bias) * pull);
}

void fill(const PoseGraph& graph, BlockSystem& system) {
  system.clear();
  for (const PoseRelation& relation : graph.path) add_relation(relation, graph.poses, 1.0, system);
  for (const Loop& loop : graph.loops) add_relation(loop.relation, graph.poses, loop.weight, system);
  if (graph.wheels.empty()) return;
  for (const WheelRelation& wheels : graph.wheels) add_wheels(wheels, graph, system);
  system.diagonal.back() += graph.bias_information;
  subtract(system.right.back(), graph.bias_information * graph.bias);
}

// Returns the largest translation, metres.
double move_by(const std::vector<Tangent2>& steps, std::vector<Pose2>& poses) {
  double farthest_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] = poses[i] * exp_tangent(steps[i]);
    farthest_m = std::max(farthest_m, std::sqrt(steps[i][0] * steps[i][0] + steps[i][1] * steps[i][1]));
  }
  return farthest_m;
}

void hold_first(BlockSystem& system) { system.diagonal.front() += Matrix3::diagonal(kHeld, kHeld, kHeld); }

constexpr double kLeastSpread = 1.0e-6;  // square metres; least spread of positions that determines a turn

Matrix3 turned_to_map(const Pose2& pose) {
  const SinCos<double> turn = sin_cos(pose.theta_rad);
  return {{turn.cos, -turn.sin, 0.0, turn.sin, turn.cos, 0.0, 0.0, 0.0, 1.0}};
}

/// The rigid motion that fits the motions of some nodes best, about the centre of their positions.
class BestMotion {
 public:
  BestMotion(const PoseGraph& graph, std::span<const std::size_t> nodes)
      : graph_(graph), share_(1.0 / static_cast<double>(nodes.size())) {
    for (const std::size_t node : nodes) centre_ += share_ * graph.poses[node].translation();
    for (const std::size_t node : nodes) spread_m2_ += (graph.poses[node].translation() - centre_).squaredNorm();
  }
  /// Motion of a node under a rigid motion (tx, ty, turn).
  [[nodiscard]] Matrix3 onto(std::size_t node) const {
    const Point2 arm = graph_.poses[node].translation() - centre_;
    return {{1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x(), 0.0, 0.0, 1.0}};
  }
  /// Contribution of a node's own motion to the best rigid one: least squares over positions.
  [[nodiscard]] Matrix3 from(std::size_t node) const {
    const Point2 arm = graph_.poses[node].translation() - centre_;
    const double per_m2 = spread_m2_ > kLeastSpread ? 1.0 / spread_m2_ : 0.0;
    return {{share_, 0.0, 0.0, 0.0, share_, 0.0, -arm.y() * per_m2, arm.x() * per_m2, 0.0}};
  }

 private:
  const PoseGraph& graph_;
  double share_;
  Point2 centre_{0.0, 0.0};
  double spread_m2_ = 0.0;
};

}  // namespace

Tangent2 relation_residual(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to) {
  return log_tangent(between(relation.T_from_to, between(T_from, T_to)));
}

double relation_chi2(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to) {
  return squared_norm(relation.information, relation_residual(relation, T_from, T_to));
}

// A perturbation of `to` on the right changes the residual by itself, one of `from` by minus itself as seen from `to`;
// the derivative of the logarithm is the identity to first order in the residual.
void add_relation(const PoseRelation& relation, const std::vector<Pose2>& poses, double weight, BlockSystem& system) {
  const Pose2& T_from = poses[relation.from];
  const Pose2& T_to = poses[relation.to];
  const Tangent2 residual = relation_residual(relation, T_from, T_to);
  const Matrix3 by_from = -1.0 * adjoint_matrix(between(T_to, T_from));
  const Matrix3 information = weight * relation.information;
  const Matrix3 cross = information * by_from;  // (to, from)
  system.diagonal[relation.to] += information;
  system.diagonal[relation.from] += transposed_times(by_from, cross);
  system.add(relation.to, relation.from, cross);
  const Tangent2 pull = information * residual;
  subtract(system.right[relation.to], pull);
  subtract(system.right[relation.from], transposed(by_from) * pull);
}

bool factorise_core(BlockSystem& core, BlockCholesky& factor) {
  hold_first(core);
  return factor.factorise(core);
}

double take_step_by_core(BlockSystem& system, const BlockCholesky& factor_of_core, std::vector<Pose2>& poses) {
  hold_first(system);
  const std::vector<Tangent2> steps = solve_near(system, factor_of_core);
  return steps.empty() ? -1.0 : move_by(steps, poses);
}

double PoseGraph::take_step(BlockSystem& system, BlockCholesky& factor) {
  fill(*this, system);
  hold_first(system);
  if (!factor.factorise(system)) return -1.0;
  std::vector<Tangent2> steps = system.right;
  factor.solve(steps);
  return move_by(steps);
}

// The bias has the last row, behind the poses.
double PoseGraph::move_by(const std::vector<Tangent2>& steps) {
  if (!wheels.empty()) add(bias, steps.back());
  return gdtslam::move_by(steps, poses);
}

double PoseGraph::largest_chi2() const {
  double largest = 0.0;
  for (const Loop& loop : loops) {
    largest = std::max(largest, relation_chi2(loop.relation, poses[loop.relation.from], poses[loop.relation.to]));
  }
  return largest;
}

void take_loop(std::vector<Loop>& loops, const Loop& loop) {
  const auto same = std::find_if(loops.begin(), loops.end(), [&](const Loop& known) {
    return known.relation.from == loop.relation.from && known.relation.to == loop.relation.to;
  });
  if (same == loops.end()) {
    push_sparingly(loops, loop);
  } else {
    *same = loop;
  }
}

// Geman and McClure's kernel of this scale.
void PoseGraph::weigh_loops(double scale) {
  for (Loop& loop : loops) {
    const double chi2 = relation_chi2(loop.relation, poses[loop.relation.from], poses[loop.relation.to]);
    const double share = scale / (scale + chi2);
    loop.weight = share * share;
  }
}

// The path counts by least squares, loops by the kernel at its final scale, whatever their weights.
double PoseGraph::cost() const {
  double sum = 0.0;
  for (const PoseRelation& relation : path) sum += relation_chi2(relation, poses[relation.from], poses[relation.to]);
  for (const WheelRelation& step : wheels)
    sum += squared_norm(step.relation.information, residual_of_wheels(step, *this));
  if (!wheels.empty()) sum += squared_norm(bias_information, bias);
  for (const Loop& loop : loops) {
    const double chi2 = relation_chi2(loop.relation, poses[loop.relation.from], poses[loop.relation.to]);
    sum += kScale * chi2 / (kScale + chi2);
  }
  return sum;
}

// Works like optimise() without a wide kernel; each step goes only as far as it makes things better.
void PoseGraph::descend() {
  BlockSystem system = system_for(*this);
  BlockCholesky factor(system);
  double least = cost();
  for (int step = 0; step < kMostSteps; ++step) {
    weigh_loops(kScale);
    fill(*this, system);
    hold_first(system);
    if (!factor.factorise(system)) return;
    std::vector<Tangent2> steps = system.right;
    factor.solve(steps);
    const std::vector<Pose2> before = poses;
    const Tangent2 bias_before = bias;
    double moved_m = move_by(steps);
    for (int halvings = 0; !(cost() < least); ++halvings) {
      poses = before;
      bias = bias_before;
      if (halvings == kMostHalvings) return;
      for (Tangent2& part : steps) part = {0.5 * part[0], 0.5 * part[1], 0.5 * part[2]};
      moved_m = move_by(steps);
    }
    least = cost();
    if (moved_m < kStill_m) return;
  }
}

// If turns contradict the path, whole steps may lead farther and farther away. If they do not come to rest, or end at a
// far higher cost, they are compared with shorter steps.
void PoseGraph::optimise(bool is_graduated) {
  if (loops.empty() && wheels.empty()) return;
  std::vector<Pose2> before = poses;
  Tangent2 bias_before = bias;
  const double cost_before = cost();
  bool is_still = false;
  BlockSystem system = system_for(*this);
  BlockCholesky factor(system);
  double width = is_graduated ? std::clamp(2.0 * largest_chi2() / kScale, 1.0, kWidest) : kSlightlyWide;
  for (int step = 0; step < kMostSteps; ++step, width = std::max(1.0, width / kNarrowing)) {
    weigh_loops(width * kScale);
    const double moved_m = take_step(system, factor);
    is_still = width <= 1.0 && moved_m < kStill_m;
    if (moved_m < 0.0 || is_still) break;
  }
  if (!is_still || !(cost() <= kFarWorse * (cost_before + kScale))) {
    const double by_whole_steps = cost();
    poses.swap(before);
    std::swap(bias, bias_before);
    descend();
    if (by_whole_steps <= cost()) {
      poses.swap(before);
      std::swap(bias, bias_before);
    }
  }
  weigh_loops(kScale);
}

void PoseGraph::settle() {
  BlockSystem system = system_for(*this);
  BlockCholesky factor(system);
  std::vector<Pose2> before = poses;
  for (int step = 0; step < kMostSteps; ++step) {
    const double moved_m = take_step(system, factor);
    if (!(moved_m >= kStill_m)) break;
  }
  if (!std::all_of(poses.begin(), poses.end(), [](const Pose2& pose) { return pose.is_finite(); })) poses.swap(before);
}

GraphCovariance::GraphCovariance(const PoseGraph& graph) : graph_(graph), system_(system_for(graph)), factor_(system_) {
  fill(graph, system_);
  hold_first(system_);
  is_known_ = factor_.factorise(system_);
}

std::vector<Matrix3> GraphCovariance::column(std::size_t node) const {
  std::vector<Matrix3> blocks = column_of_row(node);
  blocks.resize(graph_.poses.size());
  return blocks;
}

Matrix3 GraphCovariance::of_bias() const { return column_of_row(graph_.poses.size()).back(); }

std::vector<Matrix3> GraphCovariance::column_of_row(std::size_t node) const {
  std::vector<Matrix3> blocks(system_.rows());
  if (!is_known_) {
    blocks[node] = kUnsolved * Matrix3::identity();
    return blocks;
  }
  std::vector<Tangent2> right(system_.rows());
  for (int k = 0; k < 3; ++k) {
    std::fill(right.begin(), right.end(), Tangent2{});
    right[node][static_cast<std::size_t>(k)] = 1.0;
    factor_.solve(right);
    for (std::size_t row = 0; row < blocks.size(); ++row) {
      for (int r = 0; r < 3; ++r) blocks[row](r, k) = right[row][static_cast<std::size_t>(r)];
    }
  }
  return blocks;
}

Matrix3 GraphCovariance::relative(std::size_t from, std::size_t to, const std::vector<Matrix3>& of_to) const {
  if (!is_known_) return kUnsolved * Matrix3::identity();
  const Matrix3 from_from = column(from)[from];
  const Matrix3 by_from = -1.0 * adjoint_matrix(between(graph_.poses[to], graph_.poses[from]));
  const Matrix3 cross = by_from * of_to[from];
  return of_to[to] + by_from * times_transposed(from_from, by_from) + cross + transposed(cross);
}

std::vector<Matrix3> covariances_in_map(const PoseGraph& graph, std::span<const std::size_t> nodes) {
  if (nodes.empty()) return {};
  const GraphCovariance covariance(graph);
  const BestMotion best(graph, nodes);
  std::vector<Matrix3> own;
  std::vector<Matrix3> with_best;  // covariances of the best motion and each node's
  Matrix3 of_best;
  for (const std::size_t node : nodes) {
    const std::vector<Matrix3> column = covariance.column(node);
    const Matrix3 to_map = turned_to_map(graph.poses[node]);
    const auto in_map = [&](std::size_t other) {
      return turned_to_map(graph.poses[other]) * times_transposed(column[other], to_map);
    };
    Matrix3 sum;
    for (const std::size_t other : nodes) sum += best.from(other) * in_map(other);
    of_best += times_transposed(sum, best.from(node));
    with_best.push_back(sum);
    own.push_back(in_map(node));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Matrix3 onto = best.onto(nodes[i]);
    const Matrix3 cross = onto * with_best[i];
    own[i] += onto * times_transposed(of_best, onto);
    own[i] -= cross + transposed(cross);
  }
  return own;
}

std::vector<Matrix3> spread_covariances(std::span<const std::size_t> at, std::span<const Matrix3> known,
                                        std::size_t count) {
  std::vector<Matrix3> all;
  all.reserve(count);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (next < at.size() && at[next] <= i) ++next;
    const std::size_t last = next - 1;
    if (next == at.size()) {
      all.push_back(known[last]);
      continue;
    }
    const auto from = static_cast<double>(at[last]);
    const double share = (static_cast<double>(i) - from) / (static_cast<double>(at[next]) - from);
    all.push_back((1.0 - share) * known[last] + share * known[next]);
  }
  return all;
}

}  // namespace gdtslam
