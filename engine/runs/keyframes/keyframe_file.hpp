// keyframes.bin.gz of a run: the scans that its map was merged from, each with its pose, so that whatever comes after
// `map` needs the run and not the log (docs/formats.md). Ranges are whole millimetres, all else is kept bit for bit.
// Frames: the map's for poses, the laser's for bearings. Thread-safe; linear in the beams, some 160 bytes and one or
// two more a beam before packing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"

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

}  // namespace gdtslam
