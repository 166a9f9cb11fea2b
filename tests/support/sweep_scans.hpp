// Scans of a nodding laser drawn at random, with all that the assembler is told of them: for tests of what becomes of
// their beams. Frame: map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/mapping/nodding/sweep_assembler.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::test {

/// What SweepAssembler::add() takes.
struct SweepScan {
  NoddingScan scan;
  std::uint32_t index = 0;
  Pose2 T_map_fix;
  std::vector<PoseKnot> poses;
};

/// A mount with a lever, roll and yaw, and a table of a swing of up to 90 degrees in `table_bits` bits.
NoddingScanner draw_scanner(Random& random, std::uint32_t table_bits = 12);
/// A scan while crank and robot move: knots at uneven times, some beams without a return.
SweepScan draw_sweep_scan(Random& random, const NoddingScanner& scanner, std::uint32_t index, std::size_t beams);
std::vector<SweepScan> draw_sweep_scans(Random& random, const NoddingScanner& scanner, std::size_t count);

/// All points, in batches of that size.
Cloud assemble(const NoddingScanner& scanner, const AssemblyLimits& limits, const std::vector<SweepScan>& scans,
               Backend& backend);

}  // namespace gdtslam::test
