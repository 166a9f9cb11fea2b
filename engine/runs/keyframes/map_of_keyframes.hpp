// The map of a run made anew from its keyframes alone, without its log. Frame: map. Thread-safe; some 0.5 ms a
// keyframe.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/map/separate_map.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// Merges the keyframes in their order at their poses, paper equations (1) and (9) to (11). `config` is that of the
/// run. Where the log gave ranges in whole millimetres this is the run's distance field, bit for bit; else points lie
/// up to half a millimetre away, and cells differ by some millimetres (docs/formats.md). A return within half a
/// millimetre of scan.min_range or scan.max_range may count where it did not, or not where it did. Throws InputError
/// where the map would be beyond map.max_megacells.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config);
/// The map of some of them alone, by their places in the run, ascending.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config);

// Changes between the drives of a merged site, found anew from its keyframes alone. Frame: map.
// Thread-safe; linear in the beams.

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
std::vector<DriveStretch> split_drives(const DrivenKeyframes& run);

/// How views are counted that tell what changed in maps of that configuration.
ViewCounts::Limits change_view_limits(const MapperConfig& config, const ChangeLimits& limits);

/// The present state after all drives, and cells that are gone, counted from the origin of the keyframes' frame;
/// nothing of a run of one drive. Linear in the beams. Throws InputError beyond map.max_megacells.
MapChanges changes_after_all(const DrivenKeyframes& run, const MapperConfig& config);

/// Marks new walls that earlier drives saw through as occupied, and cells of removed ones as free.
void mark_changes(const MapChanges& after_all, OccupancyMap& map);
/// From cells that count from the frame's origin to those of the map.
CellOffset cells_from_origin(const GridGeometry& map);

}  // namespace gdtslam
