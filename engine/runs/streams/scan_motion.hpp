// The robot's motion by its scans alone beside that by its wheels. A mount or beams that the log states wrongly show in
// how the two differ. Frames: each motion in its own, robot at the start. Not thread-safe.
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

/// Motion by the scans of a log's begin, those of its first laser.
struct MotionByScans {
  std::vector<TimedMotion> motions;
  LaserScan first_scan;                   ///< without its ranges
  bool has_one_layout = true;             ///< beams and mount agree in all scans of all lasers
  std::optional<BeamTimes> beam_times{};  ///< unless `options` state them
};

/// Reads the begin of a range of a log, until the robot has turned enough, at most 3,000 scans: those of its first
/// laser are matched as if there were no odometry. No motions if that fails, or of what can be read only once, as a
/// pipe. Once `stop` returns true, of the scans by then.
MotionByScans motion_by_scans(const std::string& log, const ReadOptions& options, const ScanRange& range,
                              const MapperConfig& mapper, const std::function<bool()>& stop);

/// How turns by the scans go with those by the wheels, in windows of 2 s.
struct TurnAgreement {
  double slope = 0.0;  ///< turn by the scans for each radian by the wheels
  double correlation = 0.0;
  double turned_rad = 0.0;  ///< by the wheels
  std::uint64_t turns = 0;  ///< windows in which the wheels turned the robot
  [[nodiscard]] bool is_opposite() const;
};
TurnAgreement turn_agreement(std::span<const TimedMotion> motions);

/// How far the direction of straight driving by the scans is to the left of that by the wheels.
struct DirectionAgreement {
  double left_rad = 0.0;
  double concentration = 0.0;  ///< 1: the same angle everywhere; 0: any
  double stretch = 0.0;        ///< path by the scans for each metre by the wheels
  double path_m = 0.0;         ///< by the wheels
  [[nodiscard]] bool is_turned() const;
};
DirectionAgreement direction_agreement(std::span<const TimedMotion> motions);

/// Faults that are certain: a mirrored laser or swapped wheels, or a mount that is turned; and wrong times of the
/// beams.
std::vector<LogFinding> motion_findings(const MotionByScans& motion);

/// The motion and its faults, once the times of the beams are right.
struct MotionLook {
  MotionByScans motion;
  std::vector<LogFinding> faults;
  /// For the delay of odometry, which a fault that is left would feign; else nothing.
  [[nodiscard]] std::span<const TimedMotion> faultless() const;
};

/// Same as motion_by_scans, but wrong times of the beams are put right in `options`, and the motion is that with them.
MotionLook look_at_motion_by_scans(const std::string& log, ReadOptions& options, const ScanRange& range,
                                   const MapperConfig& mapper, const std::function<bool()>& stop);

}  // namespace gdtslam
