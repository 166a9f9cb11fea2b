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

/// Line of a mapped scan.
std::string pose_line(PoseFormat format, std::uint64_t scan, const MappedScan& mapped);
/// Line of a scan followed in a fixed map. Empty if the pose is unknown and the format cannot express that.
std::string pose_line(PoseFormat format, std::uint64_t scan, double stamp_s, const TrackedPose& pose);

}  // namespace gdtslam
