// Single errors, for the figures and plots of `gdtslam evaluate`, and the frame in which clouds are compared.
// Thread-safe; O(n log n).
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// Error of a pose against a reference trajectory, or of a verified relation [Kuemmerle2009], with its stamp (for a
/// relation: its second stamp).
struct TrajectoryError {
  double stamp_s = 0.0;
  double position_m = 0.0;
  double angle_deg = 0.0;
};

/// A whole estimate in the frame of the reference, after the same rigid alignment as evaluate_reference(), with the
/// error of each pose; none if the reference has no near stamp. Throws InputError if fewer than two stamps match.
struct AlignedPath {
  Trajectory trajectory;
  std::vector<std::optional<TrajectoryError>> errors;
};
AlignedPath aligned_path(const Trajectory& estimate, const Trajectory& reference);

/// Errors after the same rigid alignment as evaluate_reference(), in the order of the estimate. Throws InputError if
/// fewer than two stamps match.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const Trajectory& reference);
/// In the order of the relations; leaves out relations whose stamps the trajectory lacks.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const std::vector<Relation>& relations);

/// From a map's frame to the truth's: the rigid alignment of the estimated to the true trajectory, which moves a cloud
/// as a whole. Heights are not aligned: both frames start at the floor.
struct CloudFrame {
  Pose2 T_truth_map;
  std::optional<ReferenceReport> trajectory{};  ///< figures of the alignment; none if the frames agree by option

  [[nodiscard]] Eigen::Vector3d in_truth(const CloudPoint& point) const {
    const Point2 place_m = T_truth_map * Point2(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    return {place_m.x(), place_m.y(), static_cast<double>(point.z_m)};
  }
};

// Comparison of a trajectory with verified relations.

struct RelationCheck {
  std::vector<Relation> relations;  ///< relations with unambiguous stamps
  RelationReport report;            ///< errors of these relations
};

/// `name` is the source of the trajectory, for messages. Throws InputError at `name` if the stamps of all relations
/// occur twice, at `relations_file` if the trajectory has the stamps of none.
RelationCheck check_relations(const Trajectory& trajectory, std::span<const Relation> given,
                              const std::string& relations_file, const std::string& name, double tolerance_s = 1e-4);

// Consistency of errors with a run's stated covariances: how many errors lie within one, two and three standard
// deviations of covariance.csv, and how many would if it were right. Thread-safe; O(n log n).
//
// The covariances of two poses do not state their correlation, so a relation between them gets the sum of both. Poses
// near each other have similar errors, and then the sum is too large. Opposite errors, as at the ends of a map, exceed
// the sum's standard deviation by at most the square root of two.

inline constexpr std::size_t kStatedSigmas = 3;

/// Errors of one kind by their length in standard deviations.
struct StatedShares {
  std::uint64_t count = 0;
  std::array<std::uint64_t, kStatedSigmas> within{};  ///< one, two, three standard deviations
  double factor = 0.0;                                ///< ratio of the median error to the stated one; 0 if count is 0
  [[nodiscard]] double share(std::size_t sigmas) const {
    return count == 0 ? 0.0 : static_cast<double>(within[sigmas - 1]) / static_cast<double>(count);
  }
};

/// Shares of chi-square within 1, 4 and 9, and its median.
struct StatedTheory {
  std::array<double, kStatedSigmas> shares{};
  double median = 0.0;
};
inline constexpr StatedTheory kPoseTheory{{0.198748, 0.738536, 0.970709}, 2.365974};      ///< three degrees of freedom
inline constexpr StatedTheory kPositionTheory{{0.393469, 0.864665, 0.988891}, 1.386294};  ///< two

/// Errors of position and heading together, and of the position alone.
struct StatedReport {
  StatedShares pose;
  StatedShares position;
  std::uint64_t unstated = 0;  ///< errors with a standard deviation of zero, which cannot be judged
};

/// Standard deviation of the truth: along each axis, and of the heading.
struct TruthNoise {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// Judges relations whose stamps the trajectory has, as evaluate_relations() matches them. Needs one covariance for
/// each pose.
StatedReport stated_errors(const Trajectory& trajectory, std::span<const PoseCovariance> covariances,
                           std::span<const Relation> relations, const TruthNoise& noise, double tolerance_s = 1e-4);
/// Judges poses against a reference, after the alignment of evaluate_reference(), by their own covariances within the
/// map.
StatedReport stated_errors(const Trajectory& trajectory, std::span<const PoseCovariance> covariances,
                           const Trajectory& reference, const Pose2& T_reference_estimate, const TruthNoise& noise,
                           double tolerance_s);

}  // namespace gdtslam
