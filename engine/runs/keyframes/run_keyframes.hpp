// keyframes.bin.gz of a run: the scans that its map was merged from, each with its pose, so that commands after `map`
// need only the run and not the log (docs/formats.md). Ranges are whole millimetres, all else is kept bit for bit.
// Frames: the map's for poses, the laser's for bearings. Thread-safe; linear in the beams. Size before packing: some
// 160 bytes a scan, and one or two a beam.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// In the folder of a run.
inline constexpr const char* kKeyframeFile = "keyframes.bin.gz";

/// A scan that was merged into the map.
struct RunKeyframe {
  std::size_t scan = 0;                      ///< index into the trajectory
  Pose2 T_map_base;                          ///< pose in the map
  std::optional<PoseCovariance> covariance;  ///< present if the run closed loops
  LaserScan
      laser;  ///< the scan that was mapped; once read back, ranges are whole millimetres, and infinite without a return
};

/// All keyframes of a run, in the order of merging.
struct RunKeyframes {
  std::string config_sha256;         ///< hash of config.yaml of the run, 64 hexadecimal digits
  bool in_single_precision = false;  ///< the map used points in single precision, as runs with loops do
  std::vector<RunKeyframe> keyframes;
};

/// A range rounded to millimetres, at least 1; 0 means no return: not finite, below zero, 100 km and more.
std::uint32_t range_in_mm(float range_m);

/// Content of the file, unpacked, without its checksum at the end. Scans ascend.
std::string keyframe_bytes(const RunKeyframes& run);
/// Reads it back; `name` is for messages. Throws InputError with the byte of a fault. Allocates no memory by a stated
/// number before checking it.
RunKeyframes parse_keyframes(std::string_view bytes, const std::string& name);

/// Writes the file atomically; returns the SHA-256 of its content, which is also its checksum. Throws FileError.
std::string write_keyframes(const std::string& path, const RunKeyframes& run);

/// Throws InputError if the file is cut, damaged, of another version or another format; FileError.
RunKeyframes read_keyframes(const std::string& path);

// Makes the map of a run again from its keyframes alone, without its log. Frame: map. Thread-safe; some 0.5 ms a
// keyframe.

/// Merges the keyframes in their order at their poses, paper equations (1) and (9) to (11). `config` is that of the
/// run. If the log has ranges in whole millimetres, the result is the run's distance field, bit for bit. Else points
/// differ by up to half a millimetre, and cells by some millimetres (docs/formats.md). Rounding can move a return
/// across scan.min_range or scan.max_range. Throws InputError if the map would exceed map.max_megacells.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config);
/// The map of some keyframes, by their indices in the run, ascending.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config);

// Finds the changes between the drives of a merged site again from its keyframes alone. Frame: map. Thread-safe; linear
// in the beams.

/// Keyframes of one or several drives in one frame, as in a merged site.
struct DrivenKeyframes {
  const std::vector<RunKeyframe>& keyframes;
  const Trajectory& trajectory;            ///< with the stamps of all scans
  const std::vector<std::size_t>& drives;  ///< first scans of further drives
};
/// One of the drives.
struct DriveStretch {
  std::size_t first_keyframe = 0;
  std::size_t end_keyframe = 0;
  double first_s = 0.0;  ///< stamps of its scans
  double last_s = 0.0;
};
std::vector<DriveStretch> split_drives(const DrivenKeyframes& run);

/// Limits for counting the views that show changes, for maps of that configuration.
ViewCounts::Limits change_view_limits(const MapperConfig& config, const ChangeLimits& limits);

/// The present state after all drives, and cells that are gone, counted from the origin of the keyframes' frame;
/// empty for a run of one drive. Linear in the beams. Throws InputError beyond map.max_megacells.
MapChanges changes_after_all(const DrivenKeyframes& run, const MapperConfig& config);

/// Marks new walls that earlier drives saw through as occupied, and cells of removed ones as free.
void mark_changes(const MapChanges& after_all, OccupancyMap& map);
/// Offset from cells counted from the frame's origin to cells of the map.
CellOffset cells_from_origin(const GridGeometry& map);

}  // namespace gdtslam
