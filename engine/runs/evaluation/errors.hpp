// Single errors, which the figures of `gdtslam evaluate` summarise and plots draw, and the frame that clouds are
// compared in. Thread-safe; O(n log n).
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

/// One error of a pose against a reference trajectory, or of a verified relation [Kuemmerle2009], and when it was made
/// (of a relation: its second stamp).
struct TrajectoryError {
  double stamp_s = 0.0;
  double position_m = 0.0;
  double angle_deg = 0.0;
};

/// A whole estimate in the frame of the reference, after the same rigid alignment as evaluate_reference(), with the
/// error of each pose; nothing where no stamp of the reference is near. Throws InputError when fewer than two stamps
/// match.
struct AlignedPath {
  Trajectory trajectory;
  std::vector<std::optional<TrajectoryError>> errors;
};
AlignedPath aligned_path(const Trajectory& estimate, const Trajectory& reference);

/// After the same rigid alignment as evaluate_reference(), in the order of the estimate. Throws InputError when fewer
/// than two stamps match.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const Trajectory& reference);
/// In the order of the relations, those without their stamps in the trajectory left out.
std::vector<TrajectoryError> errors_against(const Trajectory& estimate, const std::vector<Relation>& relations);

/// From a map's frame to that of the truth: the rigid alignment of the estimated to the true trajectory, which moves a
/// cloud as a whole. Heights need none: both frames have the floor's.
struct CloudFrame {
  Pose2 T_truth_map;
  std::optional<ReferenceReport> trajectory{};  ///< figures of the alignment; none if the frames are said to agree

  [[nodiscard]] Eigen::Vector3d in_truth(const CloudPoint& point) const {
    const Point2 place_m = T_truth_map * Point2(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    return {place_m.x(), place_m.y(), static_cast<double>(point.z_m)};
  }
};

// A trajectory held against relations that somebody verified.

struct RelationCheck {
  std::vector<Relation> relations;  ///< whose stamps tell which poses are meant
  RelationReport report;            ///< on these
};

/// `name` is what the trajectory is of. Throws InputError at `name` where the stamps of all relations occur twice, at
/// `relations_file` where the trajectory has those of none.
RelationCheck check_relations(const Trajectory& trajectory, std::span<const Relation> given,
                              const std::string& relations_file, const std::string& name, double tolerance_s = 1e-4);

}  // namespace gdtslam
