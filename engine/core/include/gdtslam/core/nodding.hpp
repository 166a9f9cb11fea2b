// A nodding laser: its beams in space for an elevation of the scan plane, equation (12) of the paper with an optional
// lever arm and misalignment, and the table from a crank's phase to the elevation.
//
// Frames: `laser` is the sensor's own (x forward, y left, z up; the paper's x right and y forward turned by 90 deg);
// `level` is the laser frame at elevation zero. The nodding axis is parallel to level's y and lies `lever` behind and
// below the sensor's centre. Elevation: radians, positive lifts the forward beam. With a lever arm of zero the beams
// at +90 and -90 deg never move. Every product is written out. Thread-safe, constant time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Mount of the sensor on the nodding axis, and its height.
struct NoddingMount {
  double height_m = 0.3;         ///< height of the sensor's centre over the floor at elevation zero
  double lever_forward_m = 0.0;  ///< from the axis to the sensor's centre, in the nodding frame; zero in the paper
  double lever_up_m = 0.0;
  double sensor_roll_rad = 0.0;  ///< roll of the sensor in the nodding frame, about its forward direction
  double sensor_yaw_rad = 0.0;   ///< yaw, about its up direction; a pitch is an offset of the elevation
};

/// T_level_laser: level frame's origin is the sensor's centre at elevation zero. Equation (12).
Pose3 T_level_laser(const NoddingMount& mount, double elevation_rad);
/// The same for many elevations of one mount, with the same bits.
class LevelTurn {
 public:
  explicit LevelTurn(const NoddingMount& mount);
  [[nodiscard]] Pose3 T_level_laser(double elevation_rad) const;

 private:
  Point3 lever_m_;
  Pose3 T_axis_laser_;
};
/// T_base_laser for the sensor's place at elevation zero (the pose that a 2D log gives), at the mount's height.
Pose3 T_base_laser(const NoddingMount& mount, const Pose2& T_base_level, double elevation_rad);

/// A phase is in 2^-32 turns of the crank; it wraps with the crank.
using Phase = std::uint32_t;
Phase phase_of_turns(double turns);
double turns_of_phase(Phase phase);

/// Position of the crank at `offset_s` after the scan's stamp. Between two knots the crank turns evenly, the short way.
struct PhaseKnot {
  double offset_s = 0.0;
  Phase phase = 0;
};

/// Elevation over one turn of the crank, sampled evenly, linear in between.
class ElevationTable {
 public:
  /// 2^bits + 1 values, the last one belongs to the whole turn. Throws ConfigError for a count that is not 2^k + 1 with
  /// k from 0 to 20, or a value that is not finite or beyond 2 pi.
  explicit ElevationTable(std::vector<double> elevations_rad);
  /// The table of a mount whose elevation itself is measured: phase is elevation + pi in turns of 2 pi.
  static ElevationTable identity();

  [[nodiscard]] std::uint32_t bits() const { return bits_; }
  [[nodiscard]] const std::vector<double>& values_rad() const { return values_rad_; }
  [[nodiscard]] double elevation_rad(Phase phase) const;

 private:
  std::uint32_t bits_ = 0;
  std::vector<double> values_rad_;
};
/// The phase for which ElevationTable::identity() gives this elevation, -pi to pi.
Phase phase_of_elevation(double elevation_rad);

/// Times of the beams of a scan: beam k at stamp + first_s + k * step_s.
struct BeamTiming {
  double first_s = 0.0;
  double step_s = 0.0;
  [[nodiscard]] double of_beam_s(std::size_t beam) const { return first_s + static_cast<double>(beam) * step_s; }
};
/// The timing stated by the scan itself; none if it states none.
inline std::optional<BeamTiming> stated_timing(const LaserScan& scan) {
  if (scan.first_beam_after_s == 0.0 && scan.beam_period_s == 0.0) return std::nullopt;
  return BeamTiming{scan.first_beam_after_s, scan.beam_period_s};
}
/// Sorts the beams of the scan in the order of measurement.
inline void order_beams_by_time(LaserScan& scan) {
  if (scan.beam_period_s < 0.0) turn_beams_round(scan);
}

}  // namespace gdtslam
