#include "errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {
namespace {

double absolute_degrees(double angle_rad) { return std::fabs(deg_from_rad(wrap_angle(angle_rad))); }

}  // namespace

AlignedPath aligned_path(const Trajectory& estimate, const Trajectory& reference) {
  const ReferenceOptions options;
  const Pose2 T_reference_map = evaluate_reference(estimate, reference, options).T_reference_estimate;
  const std::vector<std::optional<std::size_t>> matches = matches_by_stamp(estimate, reference, options.tolerance_s);
  AlignedPath path;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const StampedPose& pose = estimate[i];
    const Pose2 aligned = T_reference_map * pose.T_map_base;
    path.trajectory.push_back({pose.stamp_s, aligned});
    path.errors.emplace_back();
    if (!matches[i]) continue;
    const Pose2& T_reference_base = reference[*matches[i]].T_map_base;
    path.errors.back() = TrajectoryError{pose.stamp_s, (aligned.translation() - T_reference_base.translation()).norm(),
                                         absolute_degrees(aligned.theta_rad - T_reference_base.theta_rad)};
  }
  return path;
}

std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const Trajectory& reference) {
  std::vector<TrajectoryError> errors;
  for (const std::optional<TrajectoryError>& error : aligned_path(estimate, reference).errors) {
    if (error) errors.push_back(*error);
  }
  return errors;
}

std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const std::vector<Relation>& relations) {
  constexpr double kTolerance_s = 1e-4;
  const PosesByStamp poses(estimate);
  std::vector<TrajectoryError> errors;
  for (const Relation& relation : relations) {
    const std::optional<Pose2> first = poses.find(relation.t1_s, kTolerance_s);
    const std::optional<Pose2> second = poses.find(relation.t2_s, kTolerance_s);
    if (!first || !second) continue;
    const Pose2 T_1_2 = between(*first, *second);
    errors.push_back({relation.t2_s, (T_1_2.translation() - relation.T_1_2.translation()).norm(),
                      absolute_degrees(T_1_2.theta_rad - relation.T_1_2.theta_rad)});
  }
  return errors;
}

RelationCheck check_relations(const Trajectory& trajectory, std::span<const Relation> given,
                              const std::string& relations_file, const std::string& name, double tolerance_s) {
  RelationCheck check{.relations = without_repeated_stamps(given, trajectory, tolerance_s), .report = {}};
  if (!given.empty() && check.relations.empty()) {
    throw InputError(
        {name, 0},
        fmt::format("has the stamps of all {} relations twice, a clock stepped back: cut it there", given.size()));
  }
  check.report = evaluate_relations(trajectory, check.relations, tolerance_s);
  if (check.report.all.translation_m.count > 0) return check;
  throw InputError({relations_file, 0},
                   fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                               check.relations.size(), name));
}

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
    const std::optional<std::size_t> first = poses.find_index(relation.t1_s, tolerance_s);
    const std::optional<std::size_t> second = poses.find_index(relation.t2_s, tolerance_s);
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
