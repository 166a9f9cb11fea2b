// What an edit takes out of scans and of the occupancy map that was cast from them. Frame: the edited map. Thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/runs/edits/map_region.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// Regions in which readings may not end, and regions in which they have to.
struct EndRules {
  const std::vector<MapRegion>& erased;
  const std::vector<MapRegion>& kept;
};

/// Makes readings that end where they must not no returns, and tells how many; ranges that are no return stay.
/// O(beams x corners).
std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan);

/// The part of the map that holds all cells whose centres are in every region, the others in it unknown; the map itself
/// where there are no regions. Throws InputError where nothing is left. O(cells).
OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept);

}  // namespace gdtslam
