#include "gdtslam/sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

// Names of the streams of random numbers.
constexpr std::uint64_t kWheelStream = 1;
constexpr std::uint64_t kLaserStream = 2;

double event_time_s(std::size_t index, double rate_hz) {
  return std::floor(static_cast<double>(index) / rate_hz * 1e6 + 0.5) / 1e6;
}

std::vector<float> scan_at(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster,
                           double time_s, Random random) {
  const auto T_map_laser_at = [&](double offset_s) {
    return embed(base_pose(config.wheels, plan.state_at(time_s + offset_s)) * config.T_base_laser,
                 config.laser_height_m);
  };
  return measured_ranges(config.laser, caster, T_map_laser_at, random);
}

/// Wheels, encoders and odometry, moved on from event to event.
class Robot {
 public:
  Robot(const SimulationConfig& config, const MotionPlan& plan)
      : plan_(plan),
        half_track_m_(0.5 * config.wheels.true_track_width_m()),
        encoders_(config.wheels, Random(config.seed).split(kWheelStream)),
        odometer_(config.wheels) {}

  MotionState move_to(double time_s) {
    const MotionState now = plan_.state_at(time_s);
    const double ahead_m = now.travelled_m - last_.travelled_m;
    const double turned_m = (now.turned_rad - last_.turned_rad) * half_track_m_;
    encoders_.advance(ahead_m - turned_m, ahead_m + turned_m);
    T_odom_base_ = odometer_.update(encoders_.ticks());
    last_ = now;
    return now;
  }
  [[nodiscard]] const Pose2& T_odom_base() const { return T_odom_base_; }

 private:
  const MotionPlan& plan_;
  double half_track_m_;
  WheelEncoders encoders_;
  WheelOdometer odometer_;
  MotionState last_;
  Pose2 T_odom_base_;
};

ScanRecord record_of(const SimulationConfig& config, double stamp_s, std::vector<float> ranges_m,
                     const Pose2& T_odom_base) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.first_bearing_rad = config.laser.first_bearing_rad;
  record.scan.bearing_step_rad = config.laser.bearing_step_rad;
  record.scan.max_range_m = config.laser.max_range_m;
  record.scan.ranges_m = std::move(ranges_m);
  record.scan.T_base_laser = config.T_base_laser;
  record.T_odom_base = T_odom_base;
  return record;
}

void count_beams(const LaserModel& laser, const std::vector<float>& ranges_m, SimulationSummary& summary) {
  summary.beams += ranges_m.size();
  summary.returns += static_cast<std::size_t>(std::count_if(
      ranges_m.begin(), ranges_m.end(), [&](float r) { return static_cast<double>(r) < laser.max_range_m; }));
}

}  // namespace

Pose2 base_pose(const WheelModel& wheels, const MotionState& state) {
  return state.T_map_axle * Pose2{wheels.drive.centre_ahead_of_axle_m, 0.0, 0.0};
}

std::vector<std::string> validate(const SimulationConfig& config) {
  std::vector<std::string> faults;
  for (const std::string& fault : validate(config.laser)) {
    faults.push_back("laser: " + fault);
  }
  if (!config.T_base_laser.is_finite() || !(std::fabs(config.laser_height_m) <= kMaxCoordinate_m)) {
    faults.emplace_back("laser: mount and height must be finite");
  }
  for (const std::string& fault : validate(config.wheels)) {
    faults.push_back("wheels: " + fault);
  }
  if (!(config.scan_rate_hz >= 0.01 && config.scan_rate_hz <= 10'000.0)) {
    faults.emplace_back("recording: scan_rate must be 0.01 to 10000 Hz");
  }
  if (!(config.odometry_rate_hz == 0.0 || (config.odometry_rate_hz >= 0.01 && config.odometry_rate_hz <= 10'000.0))) {
    faults.emplace_back("recording: odometry_rate must be 0 or 0.01 to 10000 Hz");
  }
  return faults;
}

SimulationSummary run_simulation(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster,
                                 const SimulationSink& sink) {
  if (const std::vector<std::string> faults = validate(config); !faults.empty()) {
    throw ConfigError(faults.front());
  }
  constexpr double kNever_s = std::numeric_limits<double>::infinity();
  const Random laser_random = Random(config.seed).split(kLaserStream);
  Robot robot(config, plan);
  SimulationSummary summary;
  while (summary.is_whole) {
    const double scan_s = event_time_s(summary.scans, config.scan_rate_hz);
    const double odometry_s =
        config.odometry_rate_hz > 0.0 ? event_time_s(summary.odometry_records, config.odometry_rate_hz) : kNever_s;
    const double now_s = std::min(scan_s, odometry_s);
    if (now_s > plan.duration_s()) {
      break;
    }
    const MotionState state = robot.move_to(now_s);
    summary.duration_s = now_s;
    summary.path_m = state.path_m;
    if (odometry_s <= scan_s) {
      sink.odometry({now_s, robot.T_odom_base()});
      ++summary.odometry_records;
      continue;
    }
    std::vector<float> ranges_m = scan_at(config, plan, caster, now_s, laser_random.split(summary.scans));
    count_beams(config.laser, ranges_m, summary);
    sink.scan({record_of(config, now_s, std::move(ranges_m), robot.T_odom_base()), base_pose(config.wheels, state)});
    ++summary.scans;
    summary.is_whole = sink.keep_on(plan.duration_s() > 0.0 ? now_s / plan.duration_s() : 1.0);
  }
  return summary;
}

}  // namespace gdtslam::sim
