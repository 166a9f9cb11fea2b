// keyframes.bin.gz of a run: the scans that its map was merged from, each with its pose, so that whatever comes after
// `map` needs the run and not the log (docs/formats.md). Ranges are whole millimetres, all else is kept bit for bit.
// Frames: the map's for poses, the laser's for bearings. Thread-safe; linear in the beams, some 160 bytes and one or
// two more a beam before packing.
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
  std::size_t scan = 0;                      ///< by its number: an index into the trajectory
  Pose2 T_map_base;                          ///< pose in the map
  std::optional<PoseCovariance> covariance;  ///< present if the run closed loops
  LaserScan
      laser;  ///< the scan that was mapped; once read back, ranges are whole millimetres, and infinite without a return
};

/// All of a run, in the order in which they were merged.
struct RunKeyframes {
  std::string config_sha256;         ///< hash of config.yaml of the run, 64 hexadecimal digits
  bool in_single_precision = false;  ///< the map took the points as floats: runs that close loops do
  std::vector<RunKeyframe> keyframes;
};

/// A range in whole millimetres, to the nearest, at least 1; 0 is no return: not finite, below zero, 100 km and more.
std::uint32_t range_in_mm(float range_m);

/// Content of the file, unpacked, without its checksum at the end. Scans ascend.
std::string keyframe_bytes(const RunKeyframes& run);
/// Back again; `name` stands in messages. Throws InputError with the byte where something does not fit: no memory is
/// taken for a number that the bytes state.
RunKeyframes parse_keyframes(std::string_view bytes, const std::string& name);

/// Writes the file, whole or not at all; returns the SHA-256 of what it holds, which is its checksum too. Throws
/// FileError.
std::string write_keyframes(const std::string& path, const RunKeyframes& run);

/// Throws InputError where the file is cut, damaged, of another version or no such file; FileError.
RunKeyframes read_keyframes(const std::string& path);

// The map of a run made anew from its keyframes alone, without its log. Frame: map. Thread-safe; some 0.5 ms a
// keyframe.

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
