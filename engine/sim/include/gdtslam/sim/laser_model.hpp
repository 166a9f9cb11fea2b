// A 2D laser range finder: the directions of its beams, and its errors on the true ranges. Bearings in the laser's
// frame (x forward, y left), beam k at first_bearing + k * step; metres, radians, seconds. Cost: one ray cast per beam.
// Thread-safe with one Random per thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/sim/ray_caster.hpp"

namespace gdtslam::sim {

/// Beams, reach and errors of a laser.
struct LaserModel {
  double first_bearing_rad = 0.0;
  double bearing_step_rad = 0.0;
  std::size_t beam_count = 0;
  double min_range_m = 0.0;       ///< nearer surfaces give no return
  double max_range_m = 0.0;       ///< surfaces at this range or beyond give no return either
  double no_return_m = 0.0;       ///< reported range without a return; at least max_range_m
  double noise_constant_m = 0.0;  ///< the standard deviation of a range r is noise_constant + noise_share * r
  double noise_share = 0.0;
  double range_resolution_m = 0.0;  ///< ranges are rounded to multiples of this; 0 keeps them
  double drop_out_share = 0.0;      ///< random beams without a return, 0 to 1
  double mirror_rate_hz = 0.0;  ///< turns of the mirror a second, which spread a scan over time; 0: all beams at once

  /// Firing time of beam k relative to the scan's stamp. The stamp is the middle of the scan, so that the robot's
  /// motion within a scan does not bias its pose.
  [[nodiscard]] double time_of_beam_s(std::size_t beam) const;
};

/// Every violation, one sentence each.
std::vector<std::string> validate(const LaserModel& laser);

/// sick-lms: SICK LMS 2xx, 180 beams from -90 deg, 1.0 deg, 1 cm, 80 m. sick-361: the same with 361 beams, 0.5 deg.
/// hokuyo-961: 961 beams from -120 to 120 deg, 0.25 deg, 1 mm, 20 m: the paper's -30 to 210 deg with 90 deg ahead.
/// lidar-360: typical of small robots, 360 beams from -180 deg, 1 deg, 1 mm, 12 m, 10 turns a second.
std::optional<LaserModel> laser_preset(std::string_view name);
const std::vector<std::string>& laser_preset_names();

/// The pose of the laser in the map at a time after the scan's stamp.
using LaserPoseAt = std::function<Pose3(double offset_s)>;

/// The true hit of a beam.
struct BeamTruth {
  double offset_s = 0.0;                                     ///< firing time, relative to the scan's stamp
  double range_m = std::numeric_limits<double>::infinity();  ///< infinity: nothing within the maximum range
  std::uint32_t triangle = 0;                                ///< triangle of the caster's mesh, if there is a range
  Vec3 hit_m{0.0, 0.0, 0.0};                                 ///< map frame, if there is a range
};

/// The truth of every beam, each cast from the laser's pose at the beam's own time.
std::vector<BeamTruth> true_beams(const LaserModel& laser, const RayCaster& caster, const LaserPoseAt& T_map_laser_at);

/// The range that the sensor reports for a true range. Always draws the same number of values from `random`.
double measured_range(const LaserModel& laser, double true_range_m, Random& random);

/// Applies measured_range() to each beam.
std::vector<float> measured_ranges(const LaserModel& laser, const std::vector<BeamTruth>& beams, Random& random);

}  // namespace gdtslam::sim
