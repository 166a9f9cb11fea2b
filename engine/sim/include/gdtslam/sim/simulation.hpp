// A robot drives through a scene and records the measurements of its wheels and its laser, together with the truth. The
// same configuration gives the same bits on every host. Each kind of error has its own stream of random numbers, and so
// has each scan by its number. Cost: a ray cast per beam. One run belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/sim/laser_model.hpp"
#include "gdtslam/sim/motion_plan.hpp"
#include "gdtslam/sim/nodding.hpp"
#include "gdtslam/sim/wheel_model.hpp"

namespace gdtslam::sim {

/// The robot's body on four wheels: the driven pair's track, `wheelbase` apart around the robot's centre. The body
/// sways with the distance driven, as on an uneven floor, so a robot that stands is still.
struct ChassisModel {
  double wheelbase_m = 0.4;
  double sway_tilt_rad = 0.0;      ///< standard deviation of roll and of pitch over the floor's
  double sway_heave_m = 0.0;       ///< standard deviation of the height over the floor
  double sway_wavelength_m = 3.0;  ///< shortest wavelength of the sway along the path; the longest is four times that
};

/// Every violation, one sentence each.
std::vector<std::string> validate(const ChassisModel& chassis);

/// The robot, its laser and its wheels.
struct SimulationConfig {
  LaserModel laser;
  Pose2 T_base_laser;
  double laser_height_m = 0.3;
  WheelModel wheels;
  ChassisModel chassis;
  std::vector<FloorPart> floor_parts;  ///< those of the scene
  double floor_m = 0.0;
  double scan_rate_hz = 10.0;
  double odometry_rate_hz = 20.0;  ///< 0: no odometry between the scans
  /// Stamp of a scan, its odometry and its truth: that of the first beam, as in ROS; else that of the middle. Not for a
  /// nodding laser.
  bool stamps_first_beam = false;
  /// A nodding mount. Its height, mirror rate and stamp share must equal those of the laser, see match_laser().
  std::optional<NoddingModel> nodding{};
  std::uint64_t seed = 1;
};

/// Copies the laser's values that the nodding mount shares.
void match_laser(SimulationConfig& config);

/// Every violation, one sentence each, prefixed with its part: "laser: ...", "wheels: ...", "chassis: ...", "recording:
/// ...", "nodding: ..."
std::vector<std::string> validate(const SimulationConfig& config);

/// A recorded scan with its truth.
struct SimulatedScan {
  ScanRecord record;
  Pose3 T_map_base;                       ///< the truth, at the scan's stamp
  double elevation_rad = 0.0;             ///< 0 without nodding
  double crank_turns = 0.0;               ///< from tick 0; 0 without nodding
  std::vector<BeamTruth> beams;           ///< hit of each beam
  const NoddingCourse* course = nullptr;  ///< the mount's true motion, valid during the sink's call; null without one
};

/// Receives the records in the order of time; at the same time odometry comes before the encoder, and the encoder
/// before a scan.
struct SimulationSink {
  std::function<void(const SimulatedScan&)> scan;
  std::function<void(const Odometry&)> odometry;
  std::function<void(const Encoder&)> encoder{};  ///< may be empty
  std::function<bool(double share)> keep_on;      ///< called after each scan with the share done; false ends the run
};

/// Totals of a simulation.
struct SimulationSummary {
  std::size_t scans = 0;
  std::size_t odometry_records = 0;
  std::size_t encoder_records = 0;
  std::size_t returns = 0;  ///< beams that measured a range
  std::size_t beams = 0;
  double duration_s = 0.0;
  double path_m = 0.0;
  bool is_whole = true;  ///< false if the sink ended it
};

/// The true pose of the robot's centre in the plan.
Pose2 base_pose(const WheelModel& wheels, const MotionState& state);

/// Throws ConfigError for a drive of more than 100,000,000 records, because a short scene can request a log that fits
/// no disk.
void require_few_records(const SimulationConfig& config, double duration_s);

/// Stamps begin at 0 and are whole microseconds. With a nodding mount the first scan comes half a scan's duration
/// later, and encoder messages continue until after the last scan, so that they cover every beam. Throws ConfigError if
/// validate() or require_few_records() refuse the configuration.
SimulationSummary run_simulation(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster,
                                 const SimulationSink& sink);

}  // namespace gdtslam::sim
