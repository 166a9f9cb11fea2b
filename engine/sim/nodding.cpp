#include "gdtslam/sim/nodding.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

// Pause between the robot's stop and the crank's start.
constexpr double kSettle_s = 0.2;

void check_faults(const NoddingModel& model, std::vector<std::string>& faults) {
  for (const EncoderFault& fault : model.faults) {
    if (!(std::fabs(fault.from_s) <= 1e6) || !(fault.to_s >= fault.from_s)) {
      faults.emplace_back("a fault of the encoder must begin at a finite time and not end before");
    }
    if (std::abs(fault.ticks) > (std::int64_t{1} << 40)) {
      faults.emplace_back("a jump of the encoder must be at most 2^40 ticks");
    }
  }
}

// A fully turning crank closes everywhere. 2,880 angles find every gap wider than an eighth of a degree; Grashof's
// inequality decides the rest.
bool closes_all_around(const calib::SweepModel& model) {
  constexpr int kAngles = 2880;
  for (int i = 0; i < kAngles; ++i) {
    if (!calib::elevation_rad(model, kTwoPi * i / kAngles)) {
      return false;
    }
  }
  const calib::GrashofClass kind = calib::grashof_class(model.bars);
  return kind == calib::GrashofClass::kCrankRocker || kind == calib::GrashofClass::kDoubleCrank;
}

// The identifier of the elevation's error among the streams of a seed.
constexpr std::uint64_t kElevationStream = 3;

SineSum random_harmonics(std::uint64_t seed) {
  Random random = Random(seed).split(kElevationStream);
  return SineSum::with_phases({{1.0, 1.0}, {0.5, 2.0}, {0.25, 3.0}}, random);
}

}  // namespace

SineSum SineSum::with_phases(std::vector<Wave> waves, Random& random) {
  double sq_sum = 0.0;
  for (const Wave& wave : waves) sq_sum += 0.5 * wave.amplitude * wave.amplitude;
  for (Wave& wave : waves) {
    wave.amplitude /= std::sqrt(sq_sum);
    wave.start_turns = random.uniform();
  }
  return {std::move(waves)};
}

double SineSum::at(double x) const {
  double sum = 0.0;
  for (const Wave& wave : waves) {
    sum += wave.amplitude * sin_cos(kTwoPi * (wave.frequency * x + wave.start_turns)).sin;
  }
  return sum;
}

std::vector<std::string> validate(const NoddingModel& model) {
  std::vector<std::string> faults = validate(model.truth);
  // Written so that a value that is not a number counts as outside.
  const auto require = [&faults](double value, double low, double high, const char* fault) {
    if (!(value >= low && value <= high)) {
      faults.emplace_back(fault);
    }
  };
  require(model.elevation_error_rad, 0.0, rad_from_deg(10.0), "elevation_error must be 0 to 10 deg");
  require(model.crank_rate_hz, 1e-4, 50.0, "crank_rate must be 0.0001 to 50 Hz");
  require(model.encoder_rate_hz, 1.0, 10'000.0, "the encoder's rate must be 1 to 10000 Hz");
  require(model.start_turns, -1e6, 1e6, "start must be at most a million turns");
  require(model.step_rad, 1e-6, kTwoPi, "step must be 0.000001 rad to one turn");
  require(model.stop_s, 0.0, 86'400.0, "stop must be 0 s to a day");
  require(model.turns_a_stop, 1, 1000, "turns must be 1 to 1000");
  require(model.stop_every_m, 0.05, 1000.0, "stop_every must be 5 cm to 1000 m");
  check_faults(model, faults);
  if (faults.empty() && !closes_all_around(model.truth)) {
    faults.emplace_back("the linkage does not close all around, so that its crank cannot turn: choose a crank-rocker");
  }
  return faults;
}

std::vector<Waypoint> with_scan_stops(const NoddingModel& model, const std::vector<Waypoint>& waypoints) {
  if (model.mode != NodMode::kStopAndScan || waypoints.empty()) {
    return waypoints;
  }
  const double pause_s = model.turns_a_stop / model.crank_rate_hz + 2.0 * kSettle_s + 1.0 / model.encoder_rate_hz;
  std::vector<Waypoint> stops;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const Point2 from_m = waypoints[i == 0 ? 0 : i - 1].position_m;
    const Point2 along_m = waypoints[i].position_m - from_m;
    const double length_m = std::sqrt(along_m.x() * along_m.x() + along_m.y() * along_m.y());
    const double parts = std::max(1.0, std::ceil(length_m / model.stop_every_m));
    if (!(static_cast<double>(stops.size()) + parts <= 100'000.0)) {
      throw ConfigError("the path has more than 100000 stops: raise stop_every");
    }
    for (double k = 1.0; k <= parts; k += 1.0) {
      Waypoint stop = waypoints[i];
      if (k < parts) {
        stop.position_m = from_m + along_m * (k / parts);
        stop.pause_s = 0.0;
      }
      stop.pause_s = std::max(stop.pause_s, pause_s);
      stops.push_back(stop);
    }
  }
  return stops;
}

NoddingCourse::NoddingCourse(const NoddingModel& model, const MotionPlan& plan, std::uint64_t seed)
    : model_(model), elevation_error_(random_harmonics(seed)) {
  if (const std::vector<std::string> faults = validate(model); !faults.empty()) {
    throw ConfigError("nodding: " + faults.front());
  }
  if (model_.mode == NodMode::kStopAndScan) {
    find_stops(plan);
  }
}

void NoddingCourse::find_stops(const MotionPlan& plan) {
  double turns = 0.0;
  for (const Stand& stand : plan.stands()) {
    // The crank starts at a message of its encoder, so that the line between two messages has no kink.
    const double from_s =
        std::ceil((stand.from_s + kSettle_s) * model_.encoder_rate_hz - 1e-6) / model_.encoder_rate_hz;
    const double left_s = stand.from_s + stand.duration_s - from_s;
    const double whole = std::floor(left_s * model_.crank_rate_hz + 1e-9);
    if (whole >= 1.0) {
      stretches_.push_back({from_s, whole, turns});
      turns += whole;
    }
  }
  if (stretches_.empty()) {
    throw ConfigError("nodding: the robot never stands long enough for a turn of the crank (" +
                      std::to_string(1.0 / model_.crank_rate_hz) + " s): give waypoints a pause");
  }
}

double NoddingCourse::turns_in_stops(double time_s) const {
  const auto after = std::upper_bound(stretches_.begin(), stretches_.end(), time_s,
                                      [](double t, const Turning& turning) { return t < turning.from_s; });
  if (after == stretches_.begin()) {
    return 0.0;
  }
  const Turning& turning = *std::prev(after);
  return turning.before + std::min(turning.turns, (time_s - turning.from_s) * model_.crank_rate_hz);
}

double NoddingCourse::turns_in_steps(double time_s) const {
  const double step_turns = model_.step_rad / kTwoPi;
  const double period_s = model_.stop_s + step_turns / model_.crank_rate_hz;
  const double steps = std::floor(time_s / period_s);
  const double turning_s = std::max(0.0, time_s - steps * period_s - model_.stop_s);
  return steps * step_turns + std::min(step_turns, turning_s * model_.crank_rate_hz);
}

double NoddingCourse::crank_turns(double time_s) const {
  switch (model_.mode) {
    case NodMode::kStopAndScan:
      return model_.start_turns + turns_in_stops(time_s);
    case NodMode::kStepped:
      return model_.start_turns + turns_in_steps(time_s);
    case NodMode::kContinuous:
      break;
  }
  return model_.start_turns + time_s * model_.crank_rate_hz;
}

double NoddingCourse::elevation_rad(double time_s) const {
  const calib::CrankEncoder& encoder = model_.truth.encoder;
  const double ticks = crank_turns(time_s) * static_cast<double>(encoder.ticks_per_turn);
  const std::optional<double> elevation = calib::elevation_rad(model_.truth, calib::crank_rad(encoder, ticks));
  if (!elevation) {
    throw ConfigError("nodding: the linkage does not close at " + std::to_string(crank_turns(time_s)) + " turns");
  }
  if (model_.elevation_error_rad == 0.0) return *elevation;
  return *elevation + model_.elevation_error_rad * elevation_error_.at(crank_turns(time_s));
}

std::optional<Encoder> NoddingCourse::message(double time_s) const {
  const auto ticks_per_turn = static_cast<double>(model_.truth.encoder.ticks_per_turn);
  double turns = crank_turns(time_s);
  double jumped = 0.0;
  for (const EncoderFault& fault : model_.faults) {
    const bool has_begun = time_s >= fault.from_s;
    const bool is_on = has_begun && time_s < fault.to_s;
    if (fault.kind == EncoderFaultKind::kMissing && is_on) {
      return std::nullopt;
    }
    if (fault.kind == EncoderFaultKind::kStop && is_on) {
      turns += crank_turns(fault.from_s) - crank_turns(time_s);
    } else if (fault.kind == EncoderFaultKind::kBackwards && has_begun) {
      turns -= 2.0 * (crank_turns(std::min(time_s, fault.to_s)) - crank_turns(fault.from_s));
    } else if (fault.kind == EncoderFaultKind::kJump && has_begun) {
      jumped += static_cast<double>(fault.ticks);
    }
  }
  double ticks = std::floor(turns * ticks_per_turn + jumped + 0.5);
  if (model_.truth.encoder.wraps) {
    ticks -= std::floor(ticks / ticks_per_turn) * ticks_per_turn;
  }
  return Encoder{time_s, static_cast<std::int64_t>(ticks)};
}

Pose3 NoddingCourse::T_base_laser(const Pose2& T_base_level, double time_s) const {
  return gdtslam::T_base_laser(model_.truth.mount, T_base_level, elevation_rad(time_s));
}

}  // namespace gdtslam::sim
