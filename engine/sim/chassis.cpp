#include "chassis.hpp"

#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

// The identifier of the sway among the streams of a seed.
constexpr std::uint64_t kSwayStream = 4;

// Waves of equal strength, one in each of eight equal parts of the band of frequencies (per metre).
SineSum random_sway(const ChassisModel& chassis, Random random) {
  constexpr std::size_t kWaves = 8;
  const double highest = 1.0 / chassis.sway_wavelength_m;
  const double lowest = 0.25 * highest;
  std::vector<SineSum::Wave> waves(kWaves);
  for (std::size_t k = 0; k < kWaves; ++k) {
    const double share = (static_cast<double>(k) + random.uniform()) / static_cast<double>(kWaves);
    waves[k] = {.amplitude = 1.0, .frequency = lowest + (highest - lowest) * share};
  }
  return SineSum::with_phases(std::move(waves), random);
}

}  // namespace

Chassis::Chassis(const SimulationConfig& config)
    : config_(config), half_track_m_(0.5 * config.wheels.true_track_width_m()) {
  const Random random = Random(config.seed).split(kSwayStream);
  roll_ = random_sway(config.chassis, random.split(0));
  pitch_ = random_sway(config.chassis, random.split(1));
  heave_ = random_sway(config.chassis, random.split(2));
}

bool Chassis::is_level() const {
  return config_.floor_parts.empty() && config_.chassis.sway_tilt_rad == 0.0 && config_.chassis.sway_heave_m == 0.0;
}

double Chassis::floor_m(const Pose2& T_map_frame, double x_m, double y_m) const {
  return floor_height_m(config_.floor_parts, config_.floor_m, T_map_frame * Point2(x_m, y_m));
}

std::array<double, 4> Chassis::floor_below_m(const Pose2& T_map_base) const {
  const double x_m = 0.5 * config_.chassis.wheelbase_m;
  return {floor_m(T_map_base, x_m, half_track_m_), floor_m(T_map_base, x_m, -half_track_m_),
          floor_m(T_map_base, -x_m, half_track_m_), floor_m(T_map_base, -x_m, -half_track_m_)};
}

std::array<double, 2> Chassis::floor_below_axle_m(const Pose2& T_map_axle) const {
  return {floor_m(T_map_axle, 0.0, half_track_m_), floor_m(T_map_axle, 0.0, -half_track_m_)};
}

// Four equal springs: the body lies in the plane that fits the four heights best.
Pose3 Chassis::T_map_base(const MotionState& state) const {
  const Pose2 T_map_plan = base_pose(config_.wheels, state);
  if (is_level()) return embed(T_map_plan, config_.floor_m);
  const auto [front_left, front_right, rear_left, rear_right] = floor_below_m(T_map_plan);
  const double ahead = 0.5 * (front_left + front_right - rear_left - rear_right) / config_.chassis.wheelbase_m;
  const double left = 0.25 * (front_left + rear_left - front_right - rear_right) / half_track_m_;
  // The x axis is (1, 0, ahead) and the normal is (-ahead, -left, 1), each in the frame turned by yaw alone.
  const ChassisModel& chassis = config_.chassis;
  const auto sway = [&](double deviation, const SineSum& wave) {
    return deviation > 0.0 ? deviation * wave.at(state.path_m) : 0.0;
  };
  const double pitch_rad = sway(chassis.sway_tilt_rad, pitch_) - atan2(ahead, 1.0);
  const double roll_rad = sway(chassis.sway_tilt_rad, roll_) + atan2(left, std::sqrt(1.0 + ahead * ahead));
  const double height_m =
      sway(chassis.sway_heave_m, heave_) + 0.25 * (front_left + front_right + rear_left + rear_right);
  return embed(T_map_plan, height_m) * Pose3{Point3::Zero(), exp_so3({0.0, pitch_rad, 0.0})} *
         Pose3{Point3::Zero(), exp_so3({roll_rad, 0.0, 0.0})};
}

std::vector<std::string> validate(const ChassisModel& chassis) {
  std::vector<std::string> faults;
  // Written so that a value that is not a number counts as outside.
  const auto require = [&faults](double value, double low, double high, const char* fault) {
    if (!(value >= low && value <= high)) faults.emplace_back(fault);
  };
  require(chassis.wheelbase_m, 0.01, 100.0, "wheelbase must be 1 cm to 100 m");
  require(chassis.sway_tilt_rad, 0.0, rad_from_deg(10.0), "sway_tilt must be 0 to 10 deg");
  require(chassis.sway_heave_m, 0.0, 1.0, "sway_heave must be 0 to 1 m");
  require(chassis.sway_wavelength_m, 0.1, 1000.0, "sway_wavelength must be 10 cm to 1000 m");
  return faults;
}

}  // namespace gdtslam::sim
