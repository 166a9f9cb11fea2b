// Compares the table of poses from `gdtslam localize` with known poses: how many are right, by state. Frames: the map's
// and, after an alignment, the truth's. Thread-safe; O(n log n).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "errors.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// A line of the table.
struct FoundPose {
  std::uint64_t scan = 0;
  double stamp_s = 0.0;
  std::string state{};  ///< its verdict or its whereabouts: "found", "tracked", ...
  bool is_ambiguous = false;
  std::optional<Pose2> T_map_base{};
  std::optional<PoseCovariance> covariance{};
};

/// True if the file begins with the columns of such a table. Throws FileError, InputError.
bool is_pose_table(const std::string& path);
/// Throws InputError with the wrong line, FileError.
std::vector<FoundPose> read_pose_table(const std::string& path);

/// A share of trials: k of n with the 95 % interval of [Wilson1927].
struct Share {
  std::uint64_t count = 0;
  std::uint64_t of = 0;
  [[nodiscard]] double value() const;
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
};

struct PoseLimits {
  double within_m = 0.10;  ///< a pose this near to the truth is right
  double within_rad = rad_from_deg(1.0);
  double tolerance_s = ReferenceOptions{}.tolerance_s;
};

/// A pose that is not within the limits.
struct WrongPose {
  std::uint64_t scan = 0;
  std::string state;
  std::optional<TrajectoryError> error;  ///< none if no pose was found
};

struct PosesReport {
  Share within;                         ///< share of all scans with a true pose, including scans without a found pose
  std::map<std::string, Share> states;  ///< the same by state
  std::uint64_t unmatched = 0;          ///< scans whose stamps the truth lacks, or has twice
  std::vector<WrongPose> wrong;         ///< in the order of the table
  ErrorSummary distance_m;              ///< errors of poses within the limits
  ErrorSummary angle_deg;
  std::optional<StatedReport> stated;  ///< statistics of poses within the limits, if the table has covariances
};
/// `T_truth_map` moves the poses into the frame of the truth. Throws InputError, without a file, if none has a true
/// pose.
PosesReport compare_poses(const std::vector<FoundPose>& poses, const Trajectory& truth, const Pose2& T_truth_map,
                          const PoseLimits& limits);

/// Leaves out scans taken at most `within_s` before or after one of these stamps.
std::vector<FoundPose> without_near(std::vector<FoundPose> poses, std::vector<double> stamps_s, double within_s);

}  // namespace gdtslam
