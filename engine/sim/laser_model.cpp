#include "gdtslam/sim/laser_model.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

// SICK LMS 2xx: 75 turns a second, 1 cm in its 80 m mode. The noise of 1 cm is between the maker's values for the
// younger LMS1xx (12 mm) and LMS5xx (6 mm).
LaserModel sick(std::size_t beam_count, double step_deg) {
  return {.first_bearing_rad = rad_from_deg(-90.0),
          .bearing_step_rad = rad_from_deg(step_deg),
          .beam_count = beam_count,
          .min_range_m = 0.02,
          .max_range_m = 80.0,
          .no_return_m = 81.91,
          .noise_constant_m = 0.01,
          .range_resolution_m = 0.01,
          .drop_out_share = 0.002,
          .mirror_rate_hz = 75.0};
}

LaserModel hokuyo() {
  return {.first_bearing_rad = rad_from_deg(-120.0),
          .bearing_step_rad = rad_from_deg(0.25),
          .beam_count = 961,
          .min_range_m = 0.06,
          .max_range_m = 20.0,
          .no_return_m = 65.533,
          .noise_constant_m = 0.01,
          .range_resolution_m = 0.001,
          .drop_out_share = 0.002,
          .mirror_rate_hz = 40.0};
}

// The laser of vacuum cleaners and small robots: full circle, 5 to 10 turns a second.
LaserModel lidar_360() {
  return {.first_bearing_rad = rad_from_deg(-180.0),
          .bearing_step_rad = rad_from_deg(1.0),
          .beam_count = 360,
          .min_range_m = 0.15,
          .max_range_m = 12.0,
          .no_return_m = 12.0,
          .noise_constant_m = 0.01,
          .range_resolution_m = 0.001,
          .drop_out_share = 0.002,
          .mirror_rate_hz = 10.0};
}

}  // namespace

double LaserModel::time_of_beam_s(std::size_t beam) const {
  if (mirror_rate_hz == 0.0) {
    return 0.0;
  }
  const double from_middle = static_cast<double>(beam) - 0.5 * static_cast<double>(beam_count - 1);
  return from_middle * bearing_step_rad / (kTwoPi * mirror_rate_hz);
}

std::vector<std::string> validate(const LaserModel& laser) {
  std::vector<std::string> faults;
  const auto require = [&faults](bool holds, const char* fault) {
    if (!holds) {
      faults.emplace_back(fault);
    }
  };
  // Written so that a value that is not a number counts as outside.
  const auto is_inside = [](double value, double low, double high) { return value >= low && value <= high; };
  require(is_inside(laser.first_bearing_rad, -kTwoPi, kTwoPi), "first_bearing must be -360 to 360 deg");
  require(is_inside(laser.bearing_step_rad, 1e-5, kPi), "bearing_step must be 0.00001 rad to 180 deg");
  require(laser.beam_count >= 1 && laser.beam_count <= 65'536, "beams must be 1 to 65536");
  require(laser.bearing_step_rad * static_cast<double>(laser.beam_count) <= kTwoPi + laser.bearing_step_rad,
          "beams times bearing_step must not exceed one turn");
  require(is_inside(laser.max_range_m, 0.01, 2.0 * kMaxCoordinate_m), "max_range must be 1 cm to 2000 m");
  require(is_inside(laser.min_range_m, 0.0, laser.max_range_m), "min_range must be 0 to max_range");
  require(is_inside(laser.no_return_m, laser.max_range_m, 1e6), "no_return must be at least max_range");
  require(is_inside(laser.noise_constant_m, 0.0, 10.0), "noise must be 0 to 10 m");
  require(is_inside(laser.noise_share, 0.0, 1.0), "noise_share must be 0 to 1");
  require(is_inside(laser.range_resolution_m, 0.0, 1.0), "range_resolution must be 0 to 1 m");
  require(is_inside(laser.drop_out_share, 0.0, 1.0), "drop_outs must be 0 to 1");
  require(laser.mirror_rate_hz == 0.0 || is_inside(laser.mirror_rate_hz, 0.1, 1e4),
          "mirror_rate must be 0 or 0.1 to 10000 Hz");
  return faults;
}

std::optional<LaserModel> laser_preset(std::string_view name) {
  if (name == "sick-lms") {
    return sick(180, 1.0);
  }
  if (name == "sick-361") {
    return sick(361, 0.5);
  }
  if (name == "hokuyo-961") {
    return hokuyo();
  }
  if (name == "lidar-360") {
    return lidar_360();
  }
  return std::nullopt;
}

const std::vector<std::string>& laser_preset_names() {
  static const std::vector<std::string> names{"sick-lms", "sick-361", "hokuyo-961", "lidar-360"};
  return names;
}

std::vector<BeamTruth> true_beams(const LaserModel& laser, const RayCaster& caster, const LaserPoseAt& T_map_laser_at) {
  std::vector<BeamTruth> beams(laser.beam_count);
  const bool is_instant = laser.mirror_rate_hz == 0.0;
  Pose3 T_map_laser = is_instant ? T_map_laser_at(0.0) : Pose3{};
  for (std::size_t k = 0; k < laser.beam_count; ++k) {
    beams[k].offset_s = laser.time_of_beam_s(k);
    if (!is_instant) {
      T_map_laser = T_map_laser_at(beams[k].offset_s);
    }
    const SinCos<double> bearing = sin_cos(laser.first_bearing_rad + static_cast<double>(k) * laser.bearing_step_rad);
    const Vec3 ahead = T_map_laser * Vec3(bearing.cos, bearing.sin, 0.0);
    const Vec3 direction = ahead - T_map_laser.translation_m;
    if (const auto hit = caster.cast({T_map_laser.translation_m, direction}, laser.max_range_m)) {
      beams[k] = {beams[k].offset_s, hit->range_m, hit->triangle, T_map_laser.translation_m + hit->range_m * direction};
    }
  }
  return beams;
}

double measured_range(const LaserModel& laser, double true_range_m, Random& random) {
  const double deviate = random.normal();
  const bool is_dropped = random.uniform() < laser.drop_out_share;
  if (is_dropped || !(true_range_m < laser.max_range_m) || true_range_m < laser.min_range_m) {
    return laser.no_return_m;
  }
  double range_m = true_range_m + deviate * (laser.noise_constant_m + laser.noise_share * true_range_m);
  if (laser.range_resolution_m > 0.0) {
    range_m = std::floor(range_m / laser.range_resolution_m + 0.5) * laser.range_resolution_m;
  }
  return range_m >= laser.min_range_m && range_m < laser.max_range_m ? range_m : laser.no_return_m;
}

std::vector<float> measured_ranges(const LaserModel& laser, const std::vector<BeamTruth>& beams, Random& random) {
  std::vector<float> measured_m;
  measured_m.reserve(beams.size());
  for (const BeamTruth& beam : beams) {
    measured_m.push_back(static_cast<float>(measured_range(laser, beam.range_m, random)));
  }
  return measured_m;
}

}  // namespace gdtslam::sim
