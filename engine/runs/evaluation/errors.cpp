#include "errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

}  // namespace gdtslam
