#include "stated_errors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

Matrix3 to_matrix(const PoseCovariance& c) { return {{c.xx, c.xy, c.xt, c.xy, c.yy, c.yt, c.xt, c.yt, c.tt}}; }

Matrix3 to_matrix(const TruthNoise& noise) {
  return Matrix3::diagonal(square(noise.sigma_m), square(noise.sigma_m), square(noise.sigma_rad));
}

/// Squared lengths of errors in standard deviations.
class StatedErrors {
 public:
  void add(const Tangent2& error, const Matrix3& covariance) {
    const double det = covariance(0, 0) * covariance(1, 1) - covariance(0, 1) * covariance(0, 1);
    const double of_position = (covariance(1, 1) * error[0] * error[0] - 2.0 * covariance(0, 1) * error[0] * error[1] +
                                covariance(0, 0) * error[1] * error[1]) /
                               det;
    const Tangent2 whitened = solve_lower(cholesky(covariance), error);
    const double of_pose = dot(whitened, whitened);
    if (!(det > 0.0) || !std::isfinite(of_pose) || !std::isfinite(of_position)) {
      ++unstated_;
      return;
    }
    pose_.push_back(of_pose);
    position_.push_back(of_position);
  }
  [[nodiscard]] StatedReport report() && {
    return {count_shares(pose_, kPoseTheory), count_shares(position_, kPositionTheory), unstated_};
  }

 private:
  static StatedShares count_shares(std::vector<double>& squares, const StatedTheory& theory) {
    StatedShares shares{.count = squares.size()};
    if (squares.empty()) return shares;
    std::sort(squares.begin(), squares.end());
    for (std::size_t k = 1; k <= kStatedSigmas; ++k) {
      const double bound = static_cast<double>(k * k);
      shares.within[k - 1] = static_cast<std::uint64_t>(
          std::distance(squares.begin(), std::upper_bound(squares.begin(), squares.end(), bound)));
    }
    shares.factor = std::sqrt(quantile_of_sorted(squares, 0.5) / theory.median);
    return shares;
  }

  std::vector<double> pose_;
  std::vector<double> position_;
  std::uint64_t unstated_ = 0;
};

/// Covariance of the second pose in the frame of the first, by first-order propagation from both.
Matrix3 relation_covariance(const Pose2& first, const Matrix3& of_first, const Pose2& T_1_2, const Matrix3& of_second) {
  const SinCos<double> turn = sin_cos(first.theta_rad);
  const Matrix3 to_first{{turn.cos, turn.sin, 0.0, -turn.sin, turn.cos, 0.0, 0.0, 0.0, 1.0}};
  Matrix3 by_first = -1.0 * to_first;
  by_first(0, 2) = T_1_2.y_m;
  by_first(1, 2) = -T_1_2.x_m;
  return by_first * times_transposed(of_first, by_first) + to_first * times_transposed(of_second, to_first);
}

}  // namespace

StatedReport stated_errors(const Trajectory& trajectory, std::span<const PoseCovariance> covariances,
                           std::span<const Relation> relations, const TruthNoise& noise, double tolerance_s) {
  const PosesByStamp poses(trajectory);
  StatedErrors errors;
  for (const Relation& relation : relations) {
    const std::optional<std::size_t> first = poses.index_of(relation.t1_s, tolerance_s);
    const std::optional<std::size_t> second = poses.index_of(relation.t2_s, tolerance_s);
    if (!first || !second) continue;
    const Pose2& T_map_1 = trajectory[*first].T_map_base;
    const Pose2 T_1_2 = between(T_map_1, trajectory[*second].T_map_base);
    const Tangent2 error{T_1_2.x_m - relation.T_1_2.x_m, T_1_2.y_m - relation.T_1_2.y_m,
                         wrap_angle(T_1_2.theta_rad - relation.T_1_2.theta_rad)};
    errors.add(error,
               relation_covariance(T_map_1, to_matrix(covariances[*first]), T_1_2, to_matrix(covariances[*second])) +
                   to_matrix(noise));
  }
  return std::move(errors).report();
}

StatedReport stated_errors(const Trajectory& trajectory, std::span<const PoseCovariance> covariances,
                           const Trajectory& reference, const Pose2& T_reference_estimate, const TruthNoise& noise,
                           double tolerance_s) {
  const std::vector<std::optional<std::size_t>> matches = matches_by_stamp(trajectory, reference, tolerance_s);
  const Pose2 T_estimate_reference = inverse(T_reference_estimate);
  StatedErrors errors;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (!matches[i]) continue;
    const Pose2 in_map = T_estimate_reference * reference[*matches[i]].T_map_base;
    const Pose2& stated = trajectory[i].T_map_base;
    errors.add({stated.x_m - in_map.x_m, stated.y_m - in_map.y_m, wrap_angle(stated.theta_rad - in_map.theta_rad)},
               to_matrix(covariances[i]) + to_matrix(noise));
  }
  return std::move(errors).report();
}

}  // namespace gdtslam
