// A robot followed in a map that stays as it is, by scans cast in that map: against the poses that they were cast from.
#include "engine/mapping/tracking/map_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Cholesky>

#include <algorithm>
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
#include "gdtslam/io/map_files.hpp"
#include "occupancy_scans.hpp"

namespace gdtslam {
namespace {

/// The drawn building, whose field is that of its cells; poses are counted from the field's corner.
struct TrackedBuilding {
  TrackedBuilding() {
    field.file = obstacle_field(map, obstacle_radius(MapConfig{}.truncation_m, map.geometry.resolution_m));
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

// Errors of three numbers in standard deviations, squared, are distributed as chi-square with three degrees of freedom:
// 3 by the mean, 97 of 100 below 9. Walls that lie on cells err less than walls anywhere, so less is allowed.
TEST(MapTracker, ErrsAsItsCovarianceSays) {
  const TrackedBuilding building;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapTracker tracker(MapperConfig{}, building.field.view(), *cpu);
  Random random(11);
  constexpr int kPoses = 200;
  double sum = 0.0;
  int below_9 = 0;
  for (int k = 0; k < kPoses; ++k) {
    const Pose2 truth = test::free_pose(building.map, random);
    const Pose2 start = building.in_field(truth);
    tracker.start_at({start.x_m + random.normal(0.0, 0.03), start.y_m + random.normal(0.0, 0.03),
                      start.theta_rad + random.normal(0.0, 0.01)});
    const MatchResult result = tracker.process(test::scan_at(building.map, truth, random), std::nullopt);
    ASSERT_TRUE(result.accepted) << k;
    const PoseCovariance c = tracker.covariance();
    Eigen::Matrix3d covariance;
    covariance << c.xx, c.xy, c.xt, c.xy, c.yy, c.yt, c.xt, c.yt, c.tt;
    const Eigen::Vector3d off(result.T_map_base.x_m - start.x_m, result.T_map_base.y_m - start.y_m,
                              wrap_angle(result.T_map_base.theta_rad - start.theta_rad));
    const double squared = off.dot(covariance.ldlt().solve(off));
    sum += squared;
    below_9 += squared < 9.0 ? 1 : 0;
  }
  EXPECT_GT(sum / kPoses, 0.5);
  EXPECT_LT(sum / kPoses, 4.5);
  EXPECT_GE(below_9, 0.93 * kPoses);
}

// A corridor without ends in sight holds a scan across it, not along it.
TEST(MapTracker, IsUnsureAlongABareCorridor) {
  TrackedBuilding building;
  building.map.cells = CellStates(building.map.geometry.cell_count());
  test::fill(building.map, {{0, 99}, {320, 100}}, CellState::kOccupied);
  test::fill(building.map, {{0, 140}, {320, 141}}, CellState::kOccupied);
  building.field.file = obstacle_field(building.map, obstacle_radius(MapConfig{}.truncation_m, 0.05));
  building.field.kernel_origin_m = {building.field.file.geometry.origin_x_m, building.field.file.geometry.origin_y_m};
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapTracker tracker(MapperConfig{}, building.field.view(), *cpu);
  const Pose2 truth{building.map.geometry.origin_x_m + 8.0, building.map.geometry.origin_y_m + 6.0, 0.5};
  tracker.start_at(building.in_field(truth));
  Random random(12);
  LaserScan scan = test::scan_at(building.map, truth, random);
  for (float& range : scan.ranges_m) range = range > 4.0F ? static_cast<float>(test::kReach_m) : range;
  ASSERT_TRUE(tracker.process(scan, std::nullopt).accepted);
  const PoseCovariance c = tracker.covariance();
  EXPECT_LT(std::sqrt(c.yy), 0.03);
  EXPECT_GT(std::sqrt(c.xx), 0.08);  // no better than it was said to be known at the start
}

/// What following a drive came to; scans, by their number.
struct Followed {
  std::vector<Whereabouts> whereabouts;
  std::vector<bool> is_ambiguous;
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
    followed.is_ambiguous.push_back(pose.is_ambiguous);
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
  constexpr std::size_t kBelieved = 25;  // steps of 5 cm and turns besides: TrackLimits::trial_m
  constexpr std::size_t kAgain = 75;     // noticed after TrackLimits::doubt_scans, believed after steps of 3 cm
  for (std::size_t k = 0; k < kLeap; ++k) {
    EXPECT_LT(followed.off_m[k], 0.1) << k;
    EXPECT_EQ(followed.whereabouts[k], k < kBelieved ? followed.whereabouts[k] : Whereabouts::kTracked) << k;
  }
  EXPECT_EQ(followed.whereabouts[0], Whereabouts::kFound);
  for (std::size_t k = kLeap; k < drive.size(); ++k) {  // no match is believed that is none
    const bool is_believed = followed.whereabouts[k] == Whereabouts::kTracked;
    EXPECT_TRUE(!is_believed || followed.off_m[k] < 0.1) << k;
    EXPECT_TRUE(k < kAgain || is_believed) << k;
  }
  EXPECT_GE(tracker.searches(), 2U);  // at the start, and once it was noticed
  std::filesystem::remove(yaml);
  std::filesystem::remove(std::filesystem::path(yaml).replace_extension(".pgm"));
}

// Two rooms of the same size with the same door to a corridor, which goes on to one side only.
OccupancyMap twin_rooms() {
  OccupancyMap map;
  map.geometry = {0.05, 0.0, 0.0, 420, 160};
  map.cells = CellStates(map.geometry.cell_count());
  const auto room = [&map](CellIndex min, CellIndex end) {
    test::fill(map, {{min.x - 1, min.y - 1}, {end.x + 1, end.y + 1}}, CellState::kOccupied);
    test::fill(map, {min, end}, CellState::kFree);
  };
  room({20, 90}, {400, 125});
  for (const std::int32_t left : {20, 130}) {
    room({left, 20}, {left + 80, 89});
    test::fill(map, {{left + 10, 20}, {left + 22, 32}}, CellState::kOccupied);
    test::fill(map, {{left + 32, 89}, {left + 50, 90}}, CellState::kFree);
  }
  return map;
}

TEST(RobotTracker, SaysThatRoomsLookAlikeUntilItHasLeftThem) {
  const std::string yaml =
      (std::filesystem::temp_directory_path() / ("gdtslam-twins-" + std::to_string(::getpid()) + ".yaml")).string();
  const OccupancyMap map = twin_rooms();
  write_occupancy_map(yaml, map);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const Localizer localizer(yaml, MapperConfig{}, LocalizeLimits{}, *cpu);
  RobotTracker tracker(localizer, MapperConfig{}, *cpu);
  std::vector<Pose2> drive;
  for (int k = 0; k < 140; ++k) {  // out of the door, and to the right along the corridor
    const double path_m = 0.05 * k;
    const double up_m = std::min(path_m, 3.4);
    drive.push_back({8.55 + (path_m - up_m), 2.0 + up_m, 0.5 * kPi + 0.1 * std::sin(0.2 * k)});
  }
  const Followed followed = follow(tracker, map, drive, drive.size());
  EXPECT_TRUE(followed.is_ambiguous.front());
  EXPECT_FALSE(followed.is_ambiguous.back());
  EXPECT_EQ(followed.whereabouts.back(), Whereabouts::kTracked);
  for (std::size_t k = 0; k < drive.size(); ++k) {  // who is wrong has said that it may be
    EXPECT_TRUE(followed.is_ambiguous[k] || followed.off_m[k] < 0.1) << k << ' ' << followed.off_m[k];
  }
  EXPECT_LT(followed.off_m.back(), 0.1);
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
