// A nodding mount on a driving robot: the crank's motion over time, the readings of its encoder, and the pose of the
// laser at any time. Frames and signs of core/nodding.hpp and calib/sweep_model.hpp; seconds from the start of the log,
// turns of the crank from tick 0 in the direction of growing ticks. A state costs O(log stops). Thread-safe.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/sim/motion_plan.hpp"

namespace gdtslam::sim {

/// Modes of the crank's motion.
enum class NodMode : std::uint8_t {
  kContinuous,   ///< the crank always turns evenly
  kStopAndScan,  ///< whole turns while the robot stands; level and at rest while it drives
  kStepped,      ///< the crank stops each step for stop_s (the paper's calibration protocol)
};

/// Faults of an encoder.
enum class EncoderFaultKind : std::uint8_t {
  kStop,       ///< repeats the same count from `from` to `to`
  kJump,       ///< counts `ticks` more from `from` on
  kBackwards,  ///< counts in the wrong direction from `from` to `to`, and goes on from there
  kMissing,    ///< sends no message from `from` to `to`
};

/// A temporary fault of the encoder, without effect on the crank itself. For tests.
struct EncoderFault {
  EncoderFaultKind kind = EncoderFaultKind::kStop;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  std::int64_t ticks = 0;
};

/// A smooth random curve of mean 0 and root mean square 1 over many turns: a sum of sine waves.
struct SineSum {
  struct Wave {
    double amplitude = 0.0;
    double frequency = 0.0;
    double start_turns = 0.0;
  };
  std::vector<Wave> waves;

  /// Waves of random phase. Only the ratios of the amplitudes count.
  static SineSum with_phases(std::vector<Wave> waves, Random& random);
  [[nodiscard]] double at(double x) const;
};

/// The true nodding mount and its encoder.
struct NoddingModel {
  calib::SweepModel truth;  ///< the real mount, but for elevation_error_rad
  /// Root mean square, over a turn, of the true elevation minus that of `truth`: three harmonics of the crank angle.
  double elevation_error_rad = 0.0;
  NodMode mode = NodMode::kContinuous;
  double crank_rate_hz = 0.15;                  ///< turns a second, while the crank turns
  double encoder_rate_hz = 100.0;               ///< messages a second
  double start_turns = 0.0;                     ///< at time 0
  double step_rad = 0.01 * 3.1415926535897932;  ///< 1.8 deg: 100 ticks of 20,000
  double stop_s = 6.25;                         ///< 250 scans of 40 Hz
  int turns_a_stop = 1;                         ///< turns that with_scan_stops() leaves time for
  double stop_every_m = 1.0;                    ///< stop-and-scan only, along the path
  std::vector<EncoderFault> faults;
};

/// Every violation, one sentence each; also a loop that does not close all around.
std::vector<std::string> validate(const NoddingModel& model);

/// Adds stops for kStopAndScan: at every waypoint and evenly in between, at most stop_every apart, each long enough for
/// the turns. Other modes return the waypoints unchanged.
std::vector<Waypoint> with_scan_stops(const NoddingModel& model, const std::vector<Waypoint>& waypoints);

/// The mount during one drive.
class NoddingCourse {
 public:
  /// The seed is that of the elevation's error. Throws ConfigError for violations in validate(), or if kStopAndScan
  /// finds no stop that is long enough.
  NoddingCourse(const NoddingModel& model, const MotionPlan& plan, std::uint64_t seed = 1);

  /// Monotonic; before 0 and after the plan's end the motion continues unchanged.
  [[nodiscard]] double crank_turns(double time_s) const;
  /// The true one, with its error.
  [[nodiscard]] double elevation_rad(double time_s) const;
  /// Nearest whole tick, with the faults applied; empty if the message is missing.
  [[nodiscard]] std::optional<Encoder> message(double time_s) const;
  [[nodiscard]] Pose3 T_base_laser(const Pose2& T_base_level, double time_s) const;
  [[nodiscard]] const NoddingModel& model() const { return model_; }

 private:
  struct Turning {
    double from_s = 0.0;
    double turns = 0.0;   ///< in this stretch
    double before = 0.0;  ///< turns before the stretch
  };
  void find_stops(const MotionPlan& plan);
  [[nodiscard]] double turns_in_stops(double time_s) const;
  [[nodiscard]] double turns_in_steps(double time_s) const;

  NoddingModel model_;
  SineSum elevation_error_;         ///< over turns of the crank, times the model's elevation_error_rad
  std::vector<Turning> stretches_;  ///< kStopAndScan only
};

}  // namespace gdtslam::sim
