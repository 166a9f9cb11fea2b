// A robot followed in a map that stays as it is, by scans cast in that map: against the poses that they were cast from.
#include "engine/mapping/map_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/localizer/map_field.hpp"
#include "engine/runs/localizer/obstacle_field.hpp"
#include "engine/runs/localizer/tracking.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "occupancy_scans.hpp"

namespace gdtslam {
namespace {

/// The drawn building, whose field is that of its cells; poses are counted from the field's corner.
struct TrackedBuilding {
  TrackedBuilding() {
    field.file = obstacle_field(map, obstacle_radius(MapConfig{}.truncation_m, map.geometry.resolution_m), best_isa());
    field.kernel_origin_m = {field.file.geometry.origin_x_m, field.file.geometry.origin_y_m};
  }
  [[nodiscard]] Pose2 in_field(const Pose2& T_map_base) const {
    return {T_map_base.x_m - field.kernel_origin_m.x(), T_map_base.y_m - field.kernel_origin_m.y(),
            T_map_base.theta_rad};
  }
  OccupancyMap map = test::drawn_building();
  MapField field;
};

// From the first room through its door into the second, in steps of 5 cm, turning to and fro.
std::vector<Pose2> drive_of(const OccupancyMap& map) {
  std::vector<Pose2> poses;
  for (int k = 0; k < 120; ++k) {
    poses.push_back(
        {map.geometry.origin_x_m + 2.5 + 0.05 * k, map.geometry.origin_y_m + 2.45, 0.3 * std::sin(0.1 * k)});
  }
  return poses;
}

// Wheels that miss 5 % of each step, and 2 % of each turn.
Pose2 by_wheels(const Pose2& T_odom_base, const Pose2& from, const Pose2& to) {
  const Pose2 step = between(from, to);
  return T_odom_base * Pose2{0.95 * step.x_m, 0.95 * step.y_m, 0.98 * step.theta_rad};
}

TEST(MapTracker, StaysWithTheRobotThoughItsWheelsDoNot) {
  const TrackedBuilding building;
  const std::vector<Pose2> drive = drive_of(building.map);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapTracker tracker(MapperConfig{}, building.field.view(), *cpu);
  tracker.start_at(building.in_field(drive.front()));
  Random random(5);
  Pose2 T_odom_base{100.0, -50.0, 2.0};  // any frame of its own
  for (std::size_t k = 0; k < drive.size(); ++k) {
    if (k > 0) T_odom_base = by_wheels(T_odom_base, drive[k - 1], drive[k]);
    const MatchResult result = tracker.process(test::scan_at(building.map, drive[k], random), T_odom_base);
    const Pose2 truth = building.in_field(drive[k]);
    ASSERT_TRUE(result.accepted) << k;
    EXPECT_FALSE(result.merged);
    EXPECT_LT((result.T_map_base.translation() - truth.translation()).norm(), 0.05) << k;  // a cell
    EXPECT_LT(std::fabs(wrap_angle(result.T_map_base.theta_rad - truth.theta_rad)), rad_from_deg(0.5)) << k;
    EXPECT_GT(result.overlap, 0.9) << k;
  }
}

TEST(MapTracker, GoesOnByTheWheelsWhereNothingIsSeen) {
  const TrackedBuilding building;
  const std::vector<Pose2> drive = drive_of(building.map);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapTracker tracker(MapperConfig{}, building.field.view(), *cpu);
  tracker.start_at(building.in_field(drive.front()));
  Random random(6);
  static_cast<void>(tracker.process(test::scan_at(building.map, drive[0], random), drive[0]));
  LaserScan blind = test::scan_at(building.map, drive[0], random);
  blind.ranges_m.assign(blind.ranges_m.size(), static_cast<float>(test::kReach_m));
  for (std::size_t k = 1; k <= 10; ++k) {
    const MatchResult result = tracker.process(blind, drive[k]);
    EXPECT_FALSE(result.accepted);
    EXPECT_EQ(result.doubt, Doubt::kFewPoints);
  }
  const MatchResult seen = tracker.process(test::scan_at(building.map, drive[11], random), drive[11]);
  EXPECT_TRUE(seen.accepted);
  EXPECT_LT((seen.T_map_base.translation() - building.in_field(drive[11]).translation()).norm(), 0.05);
}

/// What following a drive came to; scans, by their number.
struct Followed {
  std::vector<Whereabouts> whereabouts;
  std::vector<double> off_m;  ///< from the truth, 0 where nothing is known
};

// The wheels know nothing of a leap.
Followed follow(RobotTracker& tracker, const OccupancyMap& map, const std::vector<Pose2>& drive, std::size_t leap) {
  Followed followed;
  Random random(7);
  Pose2 T_odom_base;
  for (std::size_t k = 0; k < drive.size(); ++k) {
    if (k > 0 && k != leap) T_odom_base = by_wheels(T_odom_base, drive[k - 1], drive[k]);
    const TrackedPose pose = tracker.follow(test::scan_at(map, drive[k], random), T_odom_base);
    followed.whereabouts.push_back(pose.whereabouts);
    const bool is_known = pose.whereabouts != Whereabouts::kUnknown;
    followed.off_m.push_back(is_known ? (pose.T_map_base.translation() - drive[k].translation()).norm() : 0.0);
  }
  return followed;
}

TEST(RobotTracker, FindsTheStartAndTheRobotThatWasCarriedAway) {
  const std::string yaml =
      (std::filesystem::temp_directory_path() / ("gdtslam-tracker-" + std::to_string(::getpid()) + ".yaml")).string();
  const OccupancyMap map = test::drawn_building();
  write_occupancy_map(yaml, map);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const Localizer localizer(yaml, MapperConfig{}, LocalizeLimits{}, *cpu);
  RobotTracker tracker(localizer, MapperConfig{}, *cpu);
  std::vector<Pose2> drive = drive_of(map);
  constexpr std::size_t kLeap = 40;
  for (std::size_t k = kLeap; k < drive.size(); ++k) {  // into the third room
    drive[k] = {map.geometry.origin_x_m + 12.8, map.geometry.origin_y_m + 1.8 + 0.03 * static_cast<double>(k - kLeap),
                0.2 * std::sin(0.2 * static_cast<double>(k))};
  }
  const Followed followed = follow(tracker, map, drive, kLeap);
  constexpr std::size_t kNoticed = 5;  // scans: TrackLimits::doubt_scans
  for (std::size_t k = 0; k < drive.size(); ++k) {
    if (k >= kLeap && k < kLeap + kNoticed) continue;
    EXPECT_EQ(followed.whereabouts[k], k > 0 ? Whereabouts::kTracked : Whereabouts::kFound) << k;
    EXPECT_LT(followed.off_m[k], 0.1) << k;
  }
  for (std::size_t k = kLeap; k < kLeap + kNoticed; ++k) {  // no match is believed that is none
    const bool is_believed = followed.whereabouts[k] == Whereabouts::kTracked;
    EXPECT_TRUE(!is_believed || followed.off_m[k] < 0.1) << k;
  }
  EXPECT_EQ(tracker.searches(), 2U);  // at the start, and once it was noticed
  std::filesystem::remove(yaml);
  std::filesystem::remove(std::filesystem::path(yaml).replace_extension(".pgm"));
}

TEST(MapTracker, RefusesAMapLargerThanItMayBe) {
  const TrackedBuilding building;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapperConfig config;
  config.map.max_megacells = 0;
  EXPECT_THROW(MapTracker(config, building.field.view(), *cpu), ConfigError);
}

}  // namespace
}  // namespace gdtslam
