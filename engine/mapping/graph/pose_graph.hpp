// Poses along a path and the measurements between them: the path itself, which is trusted, and loops, each of which may
// be wrong. Gauss-Newton with a graduated robust kernel [Yang2020] over the loops: each loop stays, with a weight that
// can fall to zero and rise again. Frame: any; the first pose is held. The same bits on every host. Not thread-safe.
// Cost: a factorisation a step (block_cholesky.hpp).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "block_cholesky.hpp"
#include "gdtslam/core/pose.hpp"
#include "matrix3.hpp"

namespace gdtslam {

/// The measured pose of node `to` in the frame of node `from`.
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

/// Logarithm of the difference between the measured relative pose and the actual one.
Tangent2 relation_residual(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to);
double relation_chi2(const PoseRelation& relation, const Pose2& T_from, const Pose2& T_to);
/// Its normal equations at these poses, times a weight.
void add_relation(const PoseRelation& relation, const std::vector<Pose2>& poses, double weight, BlockSystem& system);
/// Moves the poses by the system's solution, the first one held. Returns the largest translation in metres; or a value
/// below zero if the system has no solution, and the poses stay. The system's own factor would be large, so that of a
/// core is used, a part of its relations that joins all poses; it may come from an earlier step.
double take_step_by_core(BlockSystem& system, const BlockCholesky& factor_of_core, std::vector<Pose2>& poses);
/// Factorises such a part, the first pose held. False if it is not positive definite.
bool factorise_core(BlockSystem& core, BlockCholesky& factor);

/// A loop and its weight, from 0 to 1.
struct Loop {
  PoseRelation relation;
  double weight = 1.0;
  bool is_ambiguous = false;  ///< another pose fits as well; the information leaves out the line between the two
  /// True if its weight exceeds a quarter: its chi2 is below the kernel's scale.
  [[nodiscard]] bool is_on() const { return weight > 0.25; }
};

/// Adds a loop. If the same loop exists already, the new one replaces it, because it comes from a better start.
void take_loop(std::vector<Loop>& loops, const Loop& loop);

class PoseGraph {
 public:
  /// Scale of the kernel: chi2 of three degrees of freedom that one right loop in a hundred exceeds.
  static constexpr double kScale = 11.345;

  std::vector<Pose2> poses;
  std::vector<PoseRelation> path;
  std::vector<Loop> loops;
  std::vector<WheelRelation> wheels{};
  Tangent2 bias{};             ///< bias of all wheel relations, beyond the one that their T_from_to are corrected for
  Matrix3 bias_information{};  ///< prior information about it, before any log

  /// Least squares over path and loops. `is_graduated` starts from a kernel so wide that every loop counts, and narrows
  /// it; otherwise the start is the current poses, for a graph that changed little. If the path is wrong, right loops
  /// may cost more than the path alone did. So only a result that does not come to rest, or costs a hundred times as
  /// much, is compared with steps that each reduce the cost; the better of the two stays.
  void optimise(bool is_graduated);
  /// Plain least squares with the current weights; the poses stay if it has no solution.
  void settle();

 private:
  double take_step(BlockSystem& system, BlockCholesky& factor);
  double move_by(const std::vector<Tangent2>& steps);
  void weigh_loops(double scale);
  [[nodiscard]] double largest_chi2() const;
  [[nodiscard]] double cost() const;
  void descend();
};

/// Uncertainty of relative poses of a graph, at its present poses and weights.
class GraphCovariance {
 public:
  explicit GraphCovariance(const PoseGraph& graph);
  /// Covariance of the tangent of between(poses[from], poses[to]); kilometres if the graph has no solution.
  [[nodiscard]] Matrix3 relative(std::size_t from, std::size_t to) const { return relative(from, to, column(to)); }
  /// The same with column(to), for many `from`.
  [[nodiscard]] Matrix3 relative(std::size_t from, std::size_t to, const std::vector<Matrix3>& of_to) const;
  /// Covariance of the bias of the wheels. The graph must have wheel relations.
  [[nodiscard]] Matrix3 of_bias() const;
  /// Covariances between the tangents of each node and of this one, the first pose held.
  [[nodiscard]] std::vector<Matrix3> column(std::size_t node) const;

 private:
  const PoseGraph& graph_;
  BlockSystem system_;
  BlockCholesky factor_;
  [[nodiscard]] std::vector<Matrix3> column_of_row(std::size_t row) const;
  bool is_known_ = false;
};

// Uncertainty of each pose of a graph within the map as a whole. A graph gives only relative poses; if its first pose
// is held, the last ones look bad whatever lies between. Here no pose is held: the best rigid motion of all is removed,
// as when a map is laid over the truth (inner constraints [Baarda1973]). Frame: map. Thread-safe. Cost: for each node
// requested three solutions of the graph's system, and some products with every other one.

/// Returns the covariances of (x, y, theta) along the map's axes, one for each node requested; the rigid motion is that
/// of these nodes' positions.
std::vector<Matrix3> covariances_in_map(const PoseGraph& graph, std::span<const std::size_t> nodes);

/// Returns `count` covariances: known at the ascending indices `at`, linear between two of these, and constant beyond
/// the last.
std::vector<Matrix3> spread_covariances(std::span<const std::size_t> at, std::span<const Matrix3> known,
                                        std::size_t count);

}  // namespace gdtslam
