// A short drive through the room of room.hpp, mapped on any backend: what tests of devices compare.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam::test {

struct DriveScan {
  LaserScan scan;
  Pose2 T_odom_base;
};
/// Every `step`-th of the first scans of drive_through_room(), with true odometry.
std::vector<DriveScan> room_scans(std::size_t count, std::size_t step);

/// A configuration that is fast, sees a part of the room, and so lets the map grow.
MapperConfig quick_config(MatcherKind matcher);

/// What came of a drive.
struct MappedDrive {
  std::vector<Pose2> poses;
  std::vector<std::uint16_t> cells;  ///< of the map, without what lies between its rows
  GridGeometry geometry;
  MapperStatistics statistics;
  std::vector<std::string> warnings;
  std::string loss;  ///< Mapper::device_loss()
};
/// `on_warning` is called with each warning, at the moment it is given.
MappedDrive map_drive(const std::vector<DriveScan>& scans, const MapperConfig& config, Backend& backend,
                      const std::function<void()>& on_warning = {});

/// Poses, map and counts are equal to the bit; fails the test otherwise.
void expect_same(const MappedDrive& found, const MappedDrive& expected);

}  // namespace gdtslam::test
