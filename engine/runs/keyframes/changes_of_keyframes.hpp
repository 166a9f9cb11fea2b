// What changed between the drives of a merged site, found anew from its keyframes alone. Frame: map.
// Thread-safe; linear in the beams.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// Keyframes of one drive or several in one frame, as a merged site has them.
struct DrivenKeyframes {
  const std::vector<RunKeyframe>& keyframes;
  const Trajectory& trajectory;            ///< with the stamps of all scans
  const std::vector<std::size_t>& drives;  ///< scans at which another drive begins
};
/// A drive among them.
struct DriveStretch {
  std::size_t first_keyframe = 0;
  std::size_t end_keyframe = 0;
  double first_s = 0.0;  ///< stamps of its scans
  double last_s = 0.0;
};
std::vector<DriveStretch> drive_stretches_of(const DrivenKeyframes& run);

/// How views are counted that tell what changed in maps of that configuration.
ViewCounts::Limits change_view_limits(const MapperConfig& config, const ChangeLimits& limits);

/// What stands now and what is gone after all drives, in cells that count from the origin of the keyframes' frame;
/// nothing of a run of one drive. Linear in the beams. Throws InputError beyond map.max_megacells.
MapChanges changes_after_all(const DrivenKeyframes& run, const MapperConfig& config);

/// What a later drive saw as a wall and earlier ones saw through is one, and what is gone is free.
void mark_changes(const MapChanges& after_all, OccupancyMap& map);
/// From cells that count from the frame's origin to those of the map.
CellOffset cells_from_origin(const GridGeometry& map);

}  // namespace gdtslam
