#include "free_network.hpp"

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastSpread = 1.0e-6;  // square metres, of positions that tell of a turn

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
