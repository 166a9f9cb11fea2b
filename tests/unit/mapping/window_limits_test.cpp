// Windows and maps that no buffer of the device holds.
#include <algorithm>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/scan_matcher.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/mapper_drive.hpp"
#include "support/queued_backend.hpp"
#include "support/room.hpp"
#include "support/small_cpu.hpp"

namespace gdtslam {
namespace {

using test::QueuedBackend;
using testing::HasSubstr;

/// A scan to be matched, and how.
struct Scene {
  MapperConfig config;
  std::vector<PointCells> points;
  Prediction prediction;
};

/// What came of a scene, and what was asked of the device for it.
struct WindowOutcome {
  MatchResult result;
  std::vector<std::string> calls;

  [[nodiscard]] std::ptrdiff_t count(std::string_view call) const {
    return std::count(calls.begin(), calls.end(), call);
  }
};

/// In a map of the room; the largest buffer has `max_buffer_bytes` once the map is there, 0: as large as ever.
WindowOutcome outcome_of(const Scene& scene, std::size_t max_buffer_bytes) {
  QueuedBackend device;
  const MapConfig& map_config = scene.config.map;
  GlobalField map(device, map_config.resolution_m, map_config.radius_cells(), 1U << 24U);
  LocalField local(device, map_config.radius_cells());
  const auto walls = test::furnished_room();
  const Pose2 seen_from{0.5, 0.2, 0.4};
  const auto seen = in_map(to_points(test::scan_of(walls, seen_from, 0.0), {0.1, 40.0}), seen_from);
  const KeyframeCells keyframe = make_keyframe_cells(seen, map_config.resolution_m, map_config.radius_cells());
  const MergeStep step{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};
  map.grow_to_hold(keyframe.window);
  local.prepare(keyframe, map);
  local.merge_into(map, step);
  if (max_buffer_bytes != 0) device.set_max_buffer_bytes(max_buffer_bytes);
  const std::size_t before = device.calls().size();
  ScanMatcher matcher(scene.config, map);
  WindowOutcome outcome{matcher.match(scene.points, scene.prediction, true), {}};
  outcome.calls.assign(device.calls().begin() + static_cast<std::ptrdiff_t>(before), device.calls().end());
  return outcome;
}

/// One window with few points.
Scene make_scene() {
  Scene scene{.config = {}, .points = {}, .prediction = {}};
  scene.config.match.matcher = MatcherKind::kExhaustive;
  scene.config.search.attempts = 1;
  const Pose2 pose{0.4, 0.1, 0.5};
  scene.points = in_cells(to_points(test::scan_of(test::furnished_room(), pose, 0.0, 60), {0.1, 40.0}),
                          scene.config.map.resolution_m);
  scene.prediction = {.T_map_base = pose, .travelled_m = 0.1, .turned_rad = 0.1, .by_odometry = true};
  return scene;
}

std::size_t window_bytes(const Scene& scene) {
  MatchRules rules(scene.config);
  rules.begin(scene.prediction, scene.points.size());
  const SearchWindow window = rules.window(1.0);
  return std::size_t{window.count_xy()} * window.count_xy() * window.count_theta() * sizeof(PoseCandidate);
}

TEST(WindowLimits, AWindowMayTakeAllOfTheLargestBuffer) {
  const Scene scene = make_scene();
  const WindowOutcome outcome = outcome_of(scene, window_bytes(scene));
  EXPECT_EQ(outcome.result.attempts, 1U);
  EXPECT_EQ(outcome.count("pose_cost"), 1);
  EXPECT_EQ(outcome.count("pose_descent"), 2);
}

TEST(WindowLimits, AByteLessIsRefusedWithBothSizesAndWhatToDo) {
  const Scene scene = make_scene();
  const std::size_t bytes = window_bytes(scene);
  try {
    outcome_of(scene, bytes - 1);
    FAIL() << "nothing was thrown";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("search window"));
    EXPECT_THAT(error.what(),
                HasSubstr(std::to_string(bytes) + " bytes, the largest allowed is " + std::to_string(bytes - 1)));
    EXPECT_THAT(error.what(), HasSubstr("lower search.max_half_width"));
  }
}

// The device has room for the map and the scans, and for the first windows: the CPU goes on, with the same results.
TEST(WindowLimits, TheCpuGoesOnWhereAWindowDoesNotFit) {
  MapperConfig config = test::quick_config(MatcherKind::kExhaustive);
  config.search.step_m = 0.05;
  config.search.step_rad = 0.0035;
  const auto scans = test::room_scans(6, 2);
  const auto cpu = make_cpu_backend({});
  const test::MappedDrive expected = test::map_drive(scans, config, *cpu);
  QueuedBackend device;
  device.set_max_buffer_bytes(2 * (expected.cells.size() + expected.cells.size() / 4));
  const test::MappedDrive found = test::map_drive(scans, config, device);
  expect_same(found, expected);
  EXPECT_THAT(found.loss, HasSubstr("search window"));
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings[0], HasSubstr("going on with the CPU"));
}

// The CPU cannot take over from itself: the error goes to the caller, then and ever after, and no warning says
// otherwise.
TEST(WindowLimits, FromTheCpuThereIsNoWayBack) {
  const auto scans = test::room_scans(4, 2);
  test::SmallCpu cpu;
  int warnings = 0;
  Mapper mapper(test::quick_config(MatcherKind::kExhaustive), cpu,
                {.fall_back = true, .cpu = {}, .warn = [&warnings](const std::string&) { ++warnings; }});
  EXPECT_TRUE(mapper.process(scans[0].scan, scans[0].T_odom_base).merged);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    EXPECT_THROW(mapper.process(scans[i].scan, scans[i].T_odom_base), DeviceError) << i;
  }
  EXPECT_THAT(mapper.device_loss(), HasSubstr("search window"));
  EXPECT_EQ(warnings, 0);
  EXPECT_FALSE(mapper.field().download().empty()) << "the map is kept";
}

// Where the map outgrows the device, the warning says what for and what to change.
TEST(WindowLimits, AMapBeyondTheLargestBufferIsNamed) {
  const MapperConfig config = test::quick_config(MatcherKind::kExhaustive);
  const auto scans = test::room_scans(24, 4);
  QueuedBackend device;
  device.set_max_buffer_bytes(100000);
  const test::MappedDrive found = test::map_drive(scans, config, device);
  EXPECT_THAT(found.loss, HasSubstr("for the map of "));
  EXPECT_THAT(found.loss, HasSubstr("a larger map.resolution makes it smaller"));
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings[0], HasSubstr("going on with the CPU"));
}

}  // namespace
}  // namespace gdtslam
