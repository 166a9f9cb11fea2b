// The robot's motion by its scans alone, compared with the motion by its wheels. Differences show a mount or beams that
// the log states wrongly. Frames: each motion in its own, robot at the start. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/runs/motion/beam_times.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// The robot's pose when a scan was taken: by odometry of the same stamp, and by the scans alone.
struct TimedMotion {
  double stamp_s = 0.0;
  Pose2 T_odom_base;
  Pose2 T_scans_base;
};

/// Motion by the scans of the first laser at the start of a log.
struct MotionByScans {
  std::vector<TimedMotion> motions;
  LaserScan first_scan;                   ///< without its ranges
  bool has_one_layout = true;             ///< all scans of all lasers have the same beams and mount
  std::optional<BeamTimes> beam_times{};  ///< unless `options` state them
};

/// Reads the start of a range of a log until the robot has turned enough, at most 3,000 scans, and matches those of the
/// first laser without odometry. No motions if that fails, or if the log is a pipe that can be read only once. Once
/// `stop` returns true, the result covers the scans read by then.
MotionByScans motion_by_scans(const std::string& log, const ReadOptions& options, const ScanRange& range,
                              const MapperConfig& mapper, const std::function<bool()>& stop);

/// Turns by the scans compared with turns by the wheels, in windows of 2 s.
struct TurnAgreement {
  double slope = 0.0;  ///< turn by the scans for each radian by the wheels
  double correlation = 0.0;
  double turned_rad = 0.0;  ///< by the wheels
  std::uint64_t turns = 0;  ///< windows in which the wheels turned the robot
  [[nodiscard]] bool is_opposite() const;
};
TurnAgreement turn_agreement(std::span<const TimedMotion> motions);

/// Angle from the direction of straight driving by the wheels to that by the scans, positive to the left.
struct DirectionAgreement {
  double left_rad = 0.0;
  double concentration = 0.0;  ///< 1: the same angle everywhere; 0: any
  double stretch = 0.0;        ///< path by the scans for each metre by the wheels
  double path_m = 0.0;         ///< by the wheels
  [[nodiscard]] bool is_turned() const;
};
DirectionAgreement direction_agreement(std::span<const TimedMotion> motions);

/// Certain faults: a mirrored laser or swapped wheels, a turned mount, wrong times of the beams.
std::vector<LogFinding> motion_findings(const MotionByScans& motion);

/// The motion and its faults, with the times of the beams corrected.
struct MotionLook {
  MotionByScans motion;
  std::vector<LogFinding> faults;
  /// The motions if no fault is left that would look like a delay of odometry; else none.
  [[nodiscard]] std::span<const TimedMotion> faultless() const;
};

/// Like motion_by_scans(), but corrects wrong times of the beams in `options` and returns the motion with them.
MotionLook look_at_motion_by_scans(const std::string& log, ReadOptions& options, const ScanRange& range,
                                   const MapperConfig& mapper, const std::function<bool()>& stop);

}  // namespace gdtslam
