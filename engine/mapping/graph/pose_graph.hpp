// Poses along a path with what was measured between them: the path itself, which is trusted, and loops, each of which
// may be wrong. Gauss-Newton with a graduated robust kernel [Yang2020] over the loops: every one stays, with a weight
// that can become nothing and come back. Frame: any; the first pose is held. The same bits on every host. Not
// thread-safe. Cost: a factorisation a step (block_cholesky.hpp).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "block_cholesky.hpp"
#include "gdtslam/core/pose.hpp"
#include "matrix3.hpp"

namespace gdtslam {

/// The pose of node `to` in the frame of node `from`, as it was measured.
struct PoseRelation {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose2 T_from_to;
  Matrix3 information{};  ///< information of the tangent at T_from_to; perturbations act on the right
};

/// A step of the path by the wheels. All such steps share the bias of the wheels (share of the distance, share of the
/// turn, turn per metre), so that the errors of a long stretch add up instead of averaging out.
struct WheelRelation {
  PoseRelation relation;
  Matrix3 by_bias{};  ///< change of the tangent at T_from_to with the bias
};

/// log of what is between the measured relative pose and the actual one.
Tangent2 relation_residual(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to);
double relation_chi2(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to);
/// Its normal equations at these poses, times a weight.
void add_relation(const PoseRelation& relation, const std::vector<Pose2>& poses, double weight, BlockSystem& system);
/// Moves the poses by the system's solution, the first one held; returns how far the farthest went, metres, or a value
/// below zero if the system has no solution, and the poses stay. The system's own factor would be large, so that of
/// `core` is used, a part of its relations that joins all poses.
double take_step_by_core(BlockSystem& system, BlockSystem& core, BlockCholesky& factor_of_core,
                         std::vector<Pose2>& poses);

/// A loop and how far it is believed, from 0 to 1.
struct Loop {
  PoseRelation relation;
  double weight = 1.0;
  bool is_ambiguous = false;  ///< another pose fits as well; the information leaves out the line between the two
  /// Whether it counts for more than a quarter: its chi2 is below the kernel's scale.
  [[nodiscard]] bool is_on() const { return weight > 0.25; }
};

/// A loop that is there already was found again, from a better start: the new one takes its place.
void take_loop(std::vector<Loop>& loops, const Loop& loop);

class PoseGraph {
 public:
  /// chi2 of three degrees of freedom that one right loop in a hundred exceeds.
  static constexpr double kScale = 11.345;

  std::vector<Pose2> poses;
  std::vector<PoseRelation> path;
  std::vector<Loop> loops;
  std::vector<WheelRelation> wheels{};
  Tangent2 bias{};             ///< bias of all wheel relations, beyond the one that their T_from_to are corrected for
  Matrix3 bias_information{};  ///< prior information about it, before any log

  /// Least squares over path and loops. `is_graduated` starts from a kernel so wide that every loop counts and narrows
  /// it; otherwise from the poses as they are, for a graph that changed by little. Loops that are right where the path
  /// is not may cost more than the path alone did: only what never comes to rest, or costs a hundred times as much, is
  /// held against steps that each make it better, and the better of the two stays.
  void optimise(bool is_graduated);
  /// Plain least squares with the weights as they are; the poses stay where it has no solution.
  void settle();

 private:
  double take_step(BlockSystem& system, BlockCholesky& factor);
  double move_by(const std::vector<Tangent2>& steps);
  void weigh_loops(double scale);
  [[nodiscard]] double largest_chi2() const;
  [[nodiscard]] double cost() const;
  void descend();
};

/// How sure relative poses of a graph are, at its present poses and weights.
class GraphCovariance {
 public:
  explicit GraphCovariance(const PoseGraph& graph);
  /// Covariance of the tangent of between(poses[from], poses[to]); kilometres if the graph has no solution.
  [[nodiscard]] Matrix3 relative(std::size_t from, std::size_t to) const;
  /// Covariance of the bias of the wheels. The graph must have wheel relations.
  [[nodiscard]] Matrix3 of_bias() const;
  /// Between the tangents of each node and of this one, the first pose held.
  [[nodiscard]] std::vector<Matrix3> column(std::size_t node) const;

 private:
  const PoseGraph& graph_;
  BlockSystem system_;
  BlockCholesky factor_;
  [[nodiscard]] std::vector<Matrix3> column_of_row(std::size_t row) const;
  bool is_known_ = false;
};

// How sure each pose of a graph is within the map as a whole. A graph tells only how poses lie to each other; held at
// its first pose, the last ones look bad whatever is in between. Here no pose is held: what is left once the best rigid
// motion of all is taken out, which is what a map laid over the truth shows (inner constraints [Baarda1973]). Frame:
// map. Thread-safe. Cost: for each node asked for three solutions of the graph's system, and some products with every
// other.

/// Returns the covariances of (x, y, theta) along the map's axes, one a node asked for; the rigid motion is that of
/// these nodes' positions.
std::vector<Matrix3> covariances_in_map(const PoseGraph& graph, std::span<const std::size_t> nodes);

/// For `count` indices, the covariances that are known at some of them, ascending, and between two of these linearly;
/// beyond the last as there.
std::vector<Matrix3> spread_covariances(std::span<const std::size_t> at, std::span<const Matrix3> known,
                                        std::size_t count);

}  // namespace gdtslam
