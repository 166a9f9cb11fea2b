#include "gdtslam/sim/simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "chassis.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

// Identifiers of the random streams.
constexpr std::uint64_t kWheelStream = 1;
constexpr std::uint64_t kLaserStream = 2;

constexpr double kMostRecords = 1.0e8;

double event_time_s(std::size_t index, double rate_hz) {
  return std::floor(static_cast<double>(index) / rate_hz * 1e6 + 0.5) / 1e6;
}

std::vector<BeamTruth> beams_at(const SimulationConfig& config, const Chassis& chassis, const MotionPlan& plan,
                                const RayCaster& caster, const NoddingCourse* course, double time_s) {
  const auto T_map_laser_at = [&](double offset_s) {
    const MotionState state = plan.state_at(time_s + offset_s);
    if (course == nullptr && chassis.is_level()) {
      return embed(base_pose(config.wheels, state) * config.T_base_laser, config.floor_m + config.laser_height_m);
    }
    return chassis.T_map_base(state) * (course != nullptr ? course->T_base_laser(config.T_base_laser, time_s + offset_s)
                                                          : embed(config.T_base_laser, config.laser_height_m));
  };
  if (!config.stamps_first_beam) return true_beams(config.laser, caster, T_map_laser_at);
  const double first_s = config.laser.time_of_beam_s(0);
  std::vector<BeamTruth> beams =
      true_beams(config.laser, caster, [&](double offset_s) { return T_map_laser_at(offset_s - first_s); });
  for (BeamTruth& beam : beams) beam.offset_s -= first_s;
  return beams;
}

/// Wheels, encoders and odometry, advanced from event to event.
class Robot {
 public:
  Robot(const SimulationConfig& config, const Chassis& chassis, const MotionPlan& plan)
      : plan_(plan),
        chassis_(chassis),
        is_floor_even_(config.floor_parts.empty()),
        half_track_m_(0.5 * config.wheels.true_track_width_m()),
        encoders_(config.wheels, Random(config.seed).split(kWheelStream)),
        odometer_(config.wheels),
        last_floor_m_(chassis.floor_below_axle_m(plan.state_at(0.0).T_map_axle)) {}

  MotionState move_to(double time_s) {
    // Pieces that are short against a sill, so that the travel over it does not depend on the rate of the odometry.
    constexpr double kPiece_s = 0.005;
    const double pieces = is_floor_even_ ? 1.0 : std::max(1.0, std::ceil((time_s - last_s_) / kPiece_s));
    double left_m = 0.0;
    double right_m = 0.0;
    const double from_s = last_s_;
    for (double k = 1.0; k <= pieces; k += 1.0) move_piece(from_s + (time_s - from_s) * (k / pieces), left_m, right_m);
    encoders_.advance(left_m, right_m);
    T_odom_base_ = odometer_.update(encoders_.ticks());
    last_s_ = time_s;
    return last_;
  }
  [[nodiscard]] const Pose2& T_odom_base() const { return T_odom_base_; }

 private:
  // Adds the travel of the wheels along the floor.
  void move_piece(double time_s, double& left_m, double& right_m) {
    const MotionState now = plan_.state_at(time_s);
    const double ahead_m = now.travelled_m - last_.travelled_m;
    const double turned_m = (now.turned_rad - last_.turned_rad) * half_track_m_;
    const std::array<double, 2> floor_m = chassis_.floor_below_axle_m(now.T_map_axle);
    left_m += along_slope(ahead_m - turned_m, floor_m[0] - last_floor_m_[0]);
    right_m += along_slope(ahead_m + turned_m, floor_m[1] - last_floor_m_[1]);
    last_ = now;
    last_floor_m_ = floor_m;
  }
  static double along_slope(double plan_m, double rise_m) {
    return rise_m == 0.0 ? plan_m : std::copysign(std::sqrt(plan_m * plan_m + rise_m * rise_m), plan_m);
  }

  const MotionPlan& plan_;
  const Chassis& chassis_;
  bool is_floor_even_;
  double half_track_m_;
  WheelEncoders encoders_;
  WheelOdometer odometer_;
  MotionState last_;
  double last_s_ = 0.0;
  std::array<double, 2> last_floor_m_;
  Pose2 T_odom_base_;
};

ScanRecord make_record(const SimulationConfig& config, double stamp_s, std::vector<float> ranges_m,
                       const Pose2& T_odom_base) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.first_bearing_rad = config.laser.first_bearing_rad;
  record.scan.bearing_step_rad = config.laser.bearing_step_rad;
  record.scan.max_range_m = config.laser.max_range_m;
  record.scan.first_beam_after_s = config.stamps_first_beam ? 0.0 : config.laser.time_of_beam_s(0);
  record.scan.beam_period_s = config.laser.time_of_beam_s(1) - config.laser.time_of_beam_s(0);
  record.scan.ranges_m = std::move(ranges_m);
  record.scan.T_base_laser = config.T_base_laser;
  record.T_odom_base = T_odom_base;
  return record;
}

// Time from a scan's first beam to its stamp, in whole microseconds.
double lead_s(const LaserModel& laser) { return std::ceil(-laser.time_of_beam_s(0) * 1e6) / 1e6; }

void count_beams(const LaserModel& laser, const std::vector<float>& ranges_m, SimulationSummary& summary) {
  summary.beams += ranges_m.size();
  summary.returns += static_cast<std::size_t>(std::count_if(ranges_m.begin(), ranges_m.end(), [&](float r) {
    return static_cast<double>(r) < limit_of_floats_m(laser.max_range_m);
  }));
}

void check_nodding(const SimulationConfig& config, std::vector<std::string>& faults) {
  const NoddingModel& nodding = *config.nodding;
  for (const std::string& fault : validate(nodding)) {
    faults.push_back("nodding: " + fault);
  }
  if (nodding.truth.mount.height_m != config.laser_height_m ||
      nodding.truth.mirror_rate_hz != config.laser.mirror_rate_hz || nodding.truth.stamp_share != 0.5) {
    faults.emplace_back("nodding: height, mirror rate and stamp must be those of the laser");
  }
}

/// Events of one kind at a fixed rate, at whole microseconds.
struct Beat {
  double rate_hz = 0.0;  // 0: none
  double first_s = 0.0;
  double until_s = 0.0;  // inclusive
  std::size_t count = 0;

  [[nodiscard]] double next_s() const {
    constexpr double kNever_s = std::numeric_limits<double>::infinity();
    const double time_s = rate_hz > 0.0 ? first_s + event_time_s(count, rate_hz) : kNever_s;
    return time_s <= until_s ? time_s : kNever_s;
  }
};

/// One simulation from its first record to its last.
class Run {
 public:
  Run(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster, const SimulationSink& sink,
      const NoddingCourse* course)
      : config_(config),
        plan_(plan),
        caster_(caster),
        sink_(sink),
        course_(course),
        chassis_(config),
        robot_(config, chassis_, plan) {
    const double end_s = plan.duration_s();
    odometry_ = {config.odometry_rate_hz, 0.0, end_s};
    scans_ = {config.scan_rate_hz, 0.0, end_s};
    if (course != nullptr) {
      const double period_s = 1.0 / config.nodding->encoder_rate_hz;
      encoder_ = {config.nodding->encoder_rate_hz, 0.0, end_s + period_s};
      scans_.first_s = lead_s(config.laser);
      scans_.until_s = end_s - scans_.first_s;
    } else if (config.stamps_first_beam) {
      scans_.until_s = end_s - 2.0 * lead_s(config.laser);
    }
  }

  SimulationSummary whole() {
    while (summary_.is_whole) {
      const double now_s = std::min({odometry_.next_s(), encoder_.next_s(), scans_.next_s()});
      if (std::isinf(now_s)) {
        break;
      }
      if (odometry_.next_s() == now_s) {
        tell_odometry(now_s);
      } else if (encoder_.next_s() == now_s) {
        tell_encoder(now_s);
      } else {
        tell_scan(now_s);
      }
    }
    return summary_;
  }

 private:
  MotionState move_to(double now_s) {
    const MotionState state = robot_.move_to(now_s);
    summary_.duration_s = now_s;
    summary_.path_m = state.path_m;
    return state;
  }

  void tell_odometry(double now_s) {
    move_to(now_s);
    sink_.odometry({now_s, robot_.T_odom_base()});
    ++odometry_.count;
    ++summary_.odometry_records;
  }

  void tell_encoder(double now_s) {
    ++encoder_.count;
    const std::optional<Encoder> message = course_->message(now_s);
    if (message && sink_.encoder) {
      sink_.encoder(*message);
      ++summary_.encoder_records;
    }
  }

  void tell_scan(double now_s) {
    const MotionState state = move_to(now_s);
    std::vector<BeamTruth> beams = beams_at(config_, chassis_, plan_, caster_, course_, now_s);
    Random random = laser_random_.split(scans_.count);
    std::vector<float> ranges_m = measured_ranges(config_.laser, beams, random);
    count_beams(config_.laser, ranges_m, summary_);
    sink_.scan({make_record(config_, now_s, std::move(ranges_m), robot_.T_odom_base()), chassis_.T_map_base(state),
                course_ != nullptr ? course_->elevation_rad(now_s) : 0.0,
                course_ != nullptr ? course_->crank_turns(now_s) : 0.0, std::move(beams), course_});
    summary_.scans = ++scans_.count;
    summary_.is_whole = sink_.keep_on(plan_.duration_s() > 0.0 ? now_s / plan_.duration_s() : 1.0);
  }

  const SimulationConfig& config_;
  const MotionPlan& plan_;
  const RayCaster& caster_;
  const SimulationSink& sink_;
  const NoddingCourse* course_;
  Chassis chassis_;
  Random laser_random_ = Random(config_.seed).split(kLaserStream);
  Robot robot_;
  Beat odometry_;
  Beat encoder_;
  Beat scans_;
  SimulationSummary summary_;
};

}  // namespace

void match_laser(SimulationConfig& config) {
  if (config.nodding) {
    config.nodding->truth.mount.height_m = config.laser_height_m;
    config.nodding->truth.mirror_rate_hz = config.laser.mirror_rate_hz;
    config.nodding->truth.stamp_share = 0.5;  // LaserModel::time_of_beam_s()
  }
}

Pose2 base_pose(const WheelModel& wheels, const MotionState& state) {
  return state.T_map_axle * Pose2{wheels.drive.centre_ahead_of_axle_m, 0.0, 0.0};
}

std::vector<std::string> validate(const SimulationConfig& config) {
  std::vector<std::string> faults;
  for (const std::string& fault : validate(config.laser)) {
    faults.push_back("laser: " + fault);
  }
  if (!config.T_base_laser.is_finite() ||
      !(config.T_base_laser.translation().cwiseAbs().maxCoeff() <= kMaxCoordinate_m) ||
      !(std::fabs(config.laser_height_m) <= kMaxCoordinate_m)) {
    faults.emplace_back("laser: mount and height must lie within 1000 m");
  }
  for (const std::string& fault : validate(config.wheels)) {
    faults.push_back("wheels: " + fault);
  }
  for (const std::string& fault : validate(config.chassis)) {
    faults.push_back("chassis: " + fault);
  }
  for (const FloorPart& part : config.floor_parts) {
    for (const std::string& fault : validate(part)) faults.push_back("floor: " + fault);
  }
  if (!(std::fabs(config.floor_m) <= kMaxCoordinate_m)) faults.emplace_back("floor: must lie within 1000 m of 0");
  if (!(config.scan_rate_hz >= 0.01 && config.scan_rate_hz <= 10'000.0)) {
    faults.emplace_back("recording: scan_rate must be 0.01 to 10000 Hz");
  }
  if (!(config.odometry_rate_hz == 0.0 || (config.odometry_rate_hz >= 0.01 && config.odometry_rate_hz <= 10'000.0))) {
    faults.emplace_back("recording: odometry_rate must be 0 or 0.01 to 10000 Hz");
  }
  if (config.nodding) {
    check_nodding(config, faults);
    if (config.stamps_first_beam)
      faults.emplace_back("recording: scans of a laser that nods are stamped in the middle");
  }
  return faults;
}

void require_few_records(const SimulationConfig& config, double duration_s) {
  const double rate_hz =
      config.scan_rate_hz + config.odometry_rate_hz + (config.nodding ? config.nodding->encoder_rate_hz : 0.0);
  const double records = std::ceil(duration_s * rate_hz);
  if (records <= kMostRecords) return;
  throw ConfigError("recording: a drive of " + std::to_string(std::llround(duration_s)) + " s has " +
                    std::to_string(std::llround(records)) + " records at these rates, more than the " +
                    std::to_string(std::llround(kMostRecords)) +
                    " that are simulated; lower scan_rate or odometry_rate, "
                    "or shorten the drive and its pauses");
}

SimulationSummary run_simulation(const SimulationConfig& config, const MotionPlan& plan, const RayCaster& caster,
                                 const SimulationSink& sink) {
  if (const std::vector<std::string> faults = validate(config); !faults.empty()) {
    throw ConfigError(faults.front());
  }
  require_few_records(config, plan.duration_s());
  std::optional<NoddingCourse> course;
  if (config.nodding) {
    course.emplace(*config.nodding, plan, config.seed);
  }
  return Run(config, plan, caster, sink, course ? &*course : nullptr).whole();
}

}  // namespace gdtslam::sim
