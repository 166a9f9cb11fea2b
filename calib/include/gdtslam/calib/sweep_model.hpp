// From the crank's encoder to the elevation of the scan plane: ticks, crank angle, rocker angle, elevation. SI units,
// radians; the linkage's frame is that of four_bar.hpp. Thread-safe, constant time unless said.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"
#include "gdtslam/core/nodding.hpp"

namespace gdtslam::calib {

/// Counting of the crank's encoder.
struct CrankEncoder {
  std::int64_t ticks_per_turn = 20000;
  double zero_rad = 0.0;  ///< crank angle at tick 0
  int direction = 1;      ///< +1: ticks grow counter-clockwise, -1: clockwise
  bool wraps = true;      ///< the counter restarts at 0 at each index mark; else it counts on
};

/// All parameters that turn a log of a nodding laser into beams in space.
struct SweepModel {
  std::string name;
  FourBar bars;
  Assembly assembly = Assembly::kOpen;
  CrankEncoder encoder;
  int elevation_sign = 1;             ///< sign of the rocker's angle
  double elevation_offset_rad = 0.0;  ///< elevation = sign * psi + offset, wrapped to [-pi, pi)
  NoddingMount mount;
  double mirror_rate_hz = 0.0;  ///< turns of the laser's mirror a second; 0 fires all beams at the scan's stamp
  double stamp_share = 0.5;     ///< position of the stamp in the scan: 0 first beam, 0.5 middle, 1 last
};

/// Every violation, one sentence each: lengths that cannot close, ticks, a length that looks like another unit.
std::vector<std::string> validate(const SweepModel& model);
/// A crank-rocker set up like the paper's: lifting is the slow stroke, elevation 0 and tick 0 are at the lowest dead
/// point. Throws ConfigError with the violated inequality if the linkage is no crank-rocker.
SweepModel sweep_model_of(const FourBar& bars, Assembly assembly);
/// A preset with this setup on a scanner like the paper's: 961 beams of 0.25 deg, 40 turns of its mirror a second.
SweepModel sweep_model_of_preset(std::string_view name);

double crank_rad(const CrankEncoder& encoder, double ticks);
/// Empty if the loop does not close.
std::optional<double> elevation_rad(const SweepModel& model, double crank_rad);
/// d elevation / d crank.
std::optional<double> elevation_rate(const SweepModel& model, double crank_rad);
/// Phase of the elevation table: turns of the crank from tick 0, in the direction of growing ticks.
Phase phase_of_ticks(const CrankEncoder& encoder, double ticks);
/// The elevation over a turn from tick 0 in the direction of growing ticks, continuous and not wrapped at half a turn;
/// O(2^bits). Throws ConfigError if the loop does not close over the whole turn.
ElevationTable elevation_table(const SweepModel& model, std::uint32_t bits = 15);
/// When beam k of `beams`, `bearing_step_rad` apart, fires relative to the scan's stamp.
BeamTiming beam_timing(const SweepModel& model, std::size_t beams, double bearing_step_rad);
/// The same for a scan, which may have its own timing.
BeamTiming beam_timing(const SweepModel& model, const LaserScan& scan);
/// Quantisation bound for judging a reconstruction: the largest error of a point at this range, metres, from one whole
/// encoder tick, one whole range step and the table (2^15 steps, float32). Half of it remains if encoder and range are
/// rounded to the nearest step instead of truncated. O(2^15).
double quantisation_bound_m(const SweepModel& model, double range_m, double range_resolution_m);

}  // namespace gdtslam::calib
