// A scan cut into strips: runs of neighbouring beams during which the crank turns evenly and the sensor's place moves
// evenly, as the kernel sweep_points takes them. How a scan is cut depends on nothing but the scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/nodding.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

/// What moved while a scan was taken. At least one knot of either kind, in the order of time.
struct ScanMotion {
  std::span<const PhaseKnot> phases;
  std::span<const PoseKnot> poses;
  BeamTiming timing;
  std::size_t beams = 0;
  Pose2 T_base_level;
};

/// Beams [first, first + count) of a scan. The pose is that of the sensor's place relative to the fix.
struct ScanStrip {
  std::size_t first = 0;
  std::uint32_t count = 0;
  Phase phase = 0;
  std::uint32_t phase_step = 0;
  Pose2 T_fix_level;
  Pose2 step;  ///< of x, y and theta, each by itself
};

/// A step of the phase is a whole number of 2^-32 turns: after so many beams the sum is at most 2^-23 of a turn off
/// (0.015 mm at 20 m).
inline constexpr std::uint32_t kMostBeamsOfStrip = 1024;
/// What a chord may cut off the arc on which the sensor's place goes when the robot turns.
inline constexpr double kMostSagitta_m = 1.0e-5;

std::vector<ScanStrip> strips_of(const ScanMotion& motion);

}  // namespace gdtslam
