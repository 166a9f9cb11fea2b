// What `gdtslam live` says of a scan: a line of JSON, or of a trajectory. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/runs/localizer/tracking.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

enum class PoseFormat : std::uint8_t { kJson, kTum };
inline constexpr std::array<std::string_view, 2> kPoseFormats{"json", "tum"};
/// One of kPoseFormats.
PoseFormat pose_format_of(std::string_view name);

/// Of a scan that was mapped.
std::string pose_line(PoseFormat format, std::uint64_t scan, const MappedScan& mapped);
/// Of one that was followed in a map that stays as it is. Empty where the place is not known and the format has no word
/// for that.
std::string pose_line(PoseFormat format, std::uint64_t scan, double stamp_s, const TrackedPose& pose);

}  // namespace gdtslam
