// Limits on the cost of reading one file, independent of the file's own statements. docs/formats.md lists these numbers
// for users.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gdtslam {

/// The largest configuration, linkage or map description.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 20U;
/// The largest scene or trajectory of waypoints.
inline constexpr std::size_t kMaxSceneBytes = std::size_t{16} << 20U;
/// Values, lists and maps of a YAML file, aliases included; each costs some hundred bytes while the file is read.
inline constexpr std::size_t kMaxYamlNodes = 1'000'000;
/// Boxes, cylinders, openings and points of walls of a scene, after every repeat, alias and place.
inline constexpr std::size_t kMaxSceneParts = 200'000;
/// The largest mesh of a scene.
inline constexpr std::uint64_t kMaxMeshBytes = std::uint64_t{512} << 20U;

/// Packed data may expand a thousand times. Data kept from a file, in memory or in a temporary file, may have this many
/// bytes plus a number for each byte read from the disk. Plain files, and packed measured values, stay far below. The
/// variable GDTSLAM_UNPACKED_MIB sets another amount for a known file.
inline constexpr std::uint64_t kFreeKeptBytes = std::uint64_t{256} << 20U;
inline constexpr std::uint64_t kKeptPerFileByte = 32;
inline constexpr const char* kFreeKeptVariable = "GDTSLAM_UNPACKED_MIB";

/// Throws InputError if `kept` bytes are too many for a file after reading `from_disk` bytes; ConfigError if the
/// variable is no whole number of MiB from 1 to 1,048,576.
void check_kept_bytes(std::uint64_t kept, std::uint64_t from_disk, const std::string& name);

/// Data computed from a file and kept beside it, such as tables of a map, may be this many times the free amount above.
inline constexpr std::uint64_t kDerivedPerFree = 16;

/// The same for `derived` bytes computed from such a file; call it before the allocation. `what` begins the message,
/// for example "searching in the map".
void check_derived_bytes(std::uint64_t derived, std::uint64_t from_disk, const std::string& name,
                         std::string_view what);

}  // namespace gdtslam
