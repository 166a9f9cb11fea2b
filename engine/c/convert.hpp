// Poses, scans and grids between gdtslam.h and the library.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gdtslam.h"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/occupancy.hpp"

/// Constant cells in rows.
struct gdtslam_grid {
  gdtslam::GridGeometry geometry;
  std::variant<std::vector<std::uint16_t>, std::vector<std::uint8_t>> cells;
  std::uint32_t cap = 0;  ///< cap of a distance field; 0 for a map

  /// Hash of a distance field, computed on the first call from any thread.
  mutable std::once_flag hashed{};
  mutable std::string sha256{};
};

namespace gdtslam::c {

inline Pose2 to_pose(const gdtslam_pose& pose) { return {pose.x_m, pose.y_m, pose.theta_rad}; }
inline gdtslam_pose to_c(const Pose2& pose) { return {pose.x_m, pose.y_m, pose.theta_rad}; }
inline gdtslam_stamped_pose to_c(const StampedPose& pose) {
  return {pose.stamp_s, pose.T_map_base.x_m, pose.T_map_base.y_m, pose.T_map_base.theta_rad};
}
std::vector<gdtslam_stamped_pose> to_c(const Trajectory& trajectory);

/// Throws UsageError, and InputError if bearings or mount are not finite. `what` names the call.
ScanRecord to_scan_record(const gdtslam_scan* scan, const char* what);
/// The ranges point into the record.
gdtslam_scan to_c(const ScanRecord& record);

std::unique_ptr<gdtslam_grid> make_grid(const DistanceFieldRows& field);
std::unique_ptr<gdtslam_grid> make_grid(const OccupancyMap& map);

}  // namespace gdtslam::c
