// Error of a trajectory: against relations between poses [Kuemmerle2009], and against a reference trajectory (ATE with
// rigid alignment [Umeyama1991] and RPE [Sturm2012]). Poses are the robot's. Thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// The poses of a trajectory by time. They may be given in any order; poses without a finite stamp are left out.
/// Thread-safe once made. O(n log n) to make, O(log n) a query.
class PosesByStamp {
 public:
  explicit PosesByStamp(const Trajectory& trajectory);
  /// The pose with the nearest stamp within the tolerance (inclusive). The earlier of two equally near stamps counts;
  /// if several poses share a stamp, the last in the log counts.
  [[nodiscard]] std::optional<Pose2> find(double stamp_s, double tolerance_s) const;
  /// Index of the pose with that stamp in the given trajectory.
  [[nodiscard]] std::optional<std::size_t> find_index(double stamp_s, double tolerance_s) const;

 private:
  struct Entry {
    StampedPose pose;
    std::size_t index = 0;
  };
  [[nodiscard]] const Entry* nearest(double stamp_s, double tolerance_s) const;

  std::vector<Entry> entries_;  // in the order of time
};

/// Stamps that occur in two stretches of a trajectory, because a clock stepped back by more than a second in between.
/// Such a stamp does not identify one pose. Thread-safe once made. O(n log n) to make, O(log n) a query.
class RepeatedStamps {
 public:
  RepeatedStamps(const Trajectory& trajectory, double tolerance_s);
  /// True if poses of two stretches are within the tolerance of the stamp.
  [[nodiscard]] bool have(double stamp_s) const;

 private:
  struct Entry {
    double stamp_s = 0.0;
    std::size_t stretch = 0;
  };
  double tolerance_s_;
  std::vector<Entry> entries_;           // in the order of time; empty if there is one stretch
  std::vector<std::size_t> next_other_;  // for each pose the next one of another stretch
};

/// Mean, sample standard deviation, largest value and root mean square of some errors.
struct ErrorSummary {
  std::size_t count = 0;
  double mean = 0.0;
  double deviation = 0.0;
  double max = 0.0;
  double rmse = 0.0;
  double median = 0.0;
};
ErrorSummary summarise(std::vector<double> errors);

/// Errors in translation and in rotation.
struct RelationErrors {
  ErrorSummary translation_m;
  ErrorSummary rotation_deg;
};

/// Errors of a trajectory over relations, all and by the time between their poses.
struct RelationReport {
  RelationErrors all;
  RelationErrors short_term;  ///< at most 20 s apart
  RelationErrors loops;       ///< further apart
  std::size_t unmatched = 0;  ///< relations whose stamps the trajectory does not have
  double worst_t1_s = 0.0;    ///< the relation with the largest translation error
  double worst_t2_s = 0.0;
};
/// Relations whose stamps identify their poses, in their order; ambiguous relations are left out.
std::vector<Relation> without_repeated_stamps(std::span<const Relation> relations, const Trajectory& trajectory,
                                              double tolerance_s = 1e-4);
/// Stamps match within `tolerance_s`; if a stamp occurs more than once, the last pose counts.
RelationReport evaluate_relations(const Trajectory& trajectory, std::span<const Relation> relations,
                                  double tolerance_s = 1e-4);

/// Errors of a trajectory against a reference: absolute and over stretches of path.
struct ReferenceReport {
  ErrorSummary ate_m;
  ErrorSummary ate_rotation_deg;
  ErrorSummary rpe_m;  ///< per `rpe_distance_m` of reference path
  ErrorSummary rpe_rotation_deg;
  std::size_t matched = 0;
  std::size_t unmatched = 0;
  Pose2 T_reference_estimate;  ///< the alignment that was applied
};
/// How stamps are matched and trajectories aligned.
struct ReferenceOptions {
  double tolerance_s = 0.01;
  double rpe_distance_m = 1.0;
  bool align = true;  ///< rigid alignment; otherwise the first poses are made to agree
};
/// Returns for each pose of a trajectory the index of the reference pose with its stamp. If stamps are not unique
/// because a clock stepped back, the stretches between such steps are matched one by one. Throws InputError if the two
/// do not have equally many stretches.
std::vector<std::optional<std::size_t>> matches_by_stamp(const Trajectory& estimate, const Trajectory& reference,
                                                         double tolerance_s);
/// Throws InputError if stamps cannot be matched, if fewer than two match, or if all of these match the same pose of
/// the reference.
ReferenceReport evaluate_reference(const Trajectory& estimate, const Trajectory& reference,
                                   const ReferenceOptions& options);

}  // namespace gdtslam
