#include "mapper_drive.hpp"

#include <gtest/gtest.h>

#include "room.hpp"

namespace gdtslam::test {

std::vector<DriveScan> room_scans(std::size_t count, std::size_t step) {
  const auto walls = furnished_room();
  const auto truth = drive_through_room();
  std::vector<DriveScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    const Pose2& pose = truth.at(i * step);
    scans.push_back({scan_of(walls, pose, static_cast<double>(i)), pose});
  }
  return scans;
}

MapperConfig quick_config(MatcherKind matcher) {
  MapperConfig config;
  config.match.matcher = matcher;
  config.scan.max_range_m = 3.0;
  config.map.resolution_m = 0.03;
  config.merge.threshold_m = 0.03;
  config.search.step_m = 0.3;
  config.search.step_rad = 0.07;
  config.search.max_half_m = 0.6;
  return config;
}

MappedDrive map_drive(const std::vector<DriveScan>& scans, const MapperConfig& config, Backend& backend,
                      const std::function<void()>& on_warning) {
  MappedDrive done;
  const auto warn = [&](const std::string& text) {
    done.warnings.push_back(text);
    if (on_warning) on_warning();
  };
  Mapper mapper(config, backend, {.fall_back = true, .cpu = {}, .warn = warn});
  for (const DriveScan& scan : scans) done.poses.push_back(mapper.process(scan.scan, scan.T_odom_base).T_map_base);
  done.cells = mapper.field().download();
  done.geometry = mapper.field().geometry();
  done.statistics = mapper.statistics();
  done.loss = mapper.device_loss();
  return done;
}

void expect_same(const MappedDrive& found, const MappedDrive& expected) {
  EXPECT_TRUE(found.poses == expected.poses);
  EXPECT_EQ(found.geometry, expected.geometry);
  EXPECT_TRUE(found.cells == expected.cells);
  EXPECT_EQ(found.statistics.scans, expected.statistics.scans);
  EXPECT_EQ(found.statistics.keyframes, expected.statistics.keyframes);
  EXPECT_EQ(found.statistics.matched, expected.statistics.matched);
  EXPECT_EQ(found.statistics.attempts, expected.statistics.attempts);
  EXPECT_EQ(found.statistics.evaluations, expected.statistics.evaluations);
}

}  // namespace gdtslam::test
