// The line that `gdtslam live` prints for a scan: JSON, or a row of a trajectory. Thread-safe.
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
PoseFormat parse_pose_format(std::string_view name);

/// A scan that was mapped.
std::string pose_line(PoseFormat format, std::uint64_t scan, const MappedScan& mapped);
/// A scan that was followed in a map that stays as it is. Empty if the place is not known and the format cannot say so.
std::string pose_line(PoseFormat format, std::uint64_t scan, double stamp_s, const TrackedPose& pose);

}  // namespace gdtslam
