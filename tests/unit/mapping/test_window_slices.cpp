// Windows that no buffer of the device holds. The reference is the same window in one piece, on a device that has room
// for it: pose, evidence and the evaluations of all descents must be equal, so all of them began at the same poses.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/local_field.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "gdtslam/mapping/window_matcher.hpp"
#include "support/mapper_drive.hpp"
#include "support/queued_backend.hpp"
#include "support/room.hpp"

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

std::size_t layer_bytes(const MapperConfig& config) {
  MatchRules rules(config);
  rules.begin({}, 1);
  const std::size_t side = rules.window(1.0).count_xy();
  return side * side * sizeof(PoseCandidate);
}

/// What came of a scene, and what was asked of the device for it.
struct Outcome {
  MatchResult result;
  std::vector<std::string> calls;

  [[nodiscard]] std::ptrdiff_t count(std::string_view call) const {
    return std::count(calls.begin(), calls.end(), call);
  }
};

/// In a map of the room; the largest buffer has `max_buffer_bytes` once the map is there, 0: as large as ever.
Outcome outcome_of(const Scene& scene, std::size_t max_buffer_bytes) {
  QueuedBackend device;
  const MapConfig& map_config = scene.config.map;
  GlobalField map(device, map_config.resolution_m, map_config.radius_cells(), 1U << 24U);
  LocalField local(device, map_config.radius_cells());
  const auto walls = test::furnished_room();
  const Pose2 seen_from{0.5, 0.2, 0.4};
  const auto seen = in_map(points_of(test::scan_of(walls, seen_from, 0.0), {0.1, 40.0}), seen_from);
  const KeyframeCells keyframe = keyframe_of(seen, map_config.resolution_m, map_config.radius_cells());
  const MergeStep step{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};
  map.admit(keyframe, step);
  local.compute(keyframe);
  local.merge_into(map, step);
  if (max_buffer_bytes != 0) device.set_max_buffer_bytes(max_buffer_bytes);
  const std::size_t before = device.calls().size();
  WindowMatcher matcher(scene.config, device, map);
  Outcome outcome{matcher.match(scene.points, scene.prediction, true), {}};
  outcome.calls.assign(device.calls().begin() + static_cast<std::ptrdiff_t>(before), device.calls().end());
  return outcome;
}

void expect_equal(const MatchResult& found, const MatchResult& expected) {
  EXPECT_EQ(found.T_map_base, expected.T_map_base);
  EXPECT_EQ(found.evaluations, expected.evaluations);
  EXPECT_EQ(found.attempts, expected.attempts);
  EXPECT_EQ(found.mean_cost_m, expected.mean_cost_m);
  EXPECT_EQ(found.overlap, expected.overlap);
  EXPECT_EQ(found.contradiction, expected.contradiction);
  EXPECT_EQ(found.stop, expected.stop);
  EXPECT_EQ(found.doubt, expected.doubt);
}

/// Nothing is refused, so that a result shows the pose that was found.
MapperConfig frank_config() {
  MapperConfig config;
  config.match.matcher = MatcherKind::kExhaustive;
  config.doubt.max_contradiction = 1.0;
  config.doubt.min_overlap = 0.0;
  return config;
}

/// Points of the room, points anywhere, or one to three points, under which most poses are equally good.
std::vector<PointCells> points_of_scene(Random& random, double resolution_m) {
  if (random.below(3) == 0) {
    const Pose2 pose{0.4, 0.1, 0.5};
    return in_cells(points_of(test::scan_of(test::furnished_room(), pose, 0.0, 60), {0.1, 40.0}), resolution_m);
  }
  std::vector<PointCells> points(random.below(2) == 0 ? 1 + random.below(3) : 40);
  for (PointCells& point : points) {
    point = {static_cast<float>(random.uniform(-200.0, 200.0)), static_cast<float>(random.uniform(-200.0, 200.0))};
  }
  return points;
}

Scene make_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene{.config = frank_config(), .points = {}, .prediction = {}};
  SearchConfig& search = scene.config.search;
  search.half_m = random.uniform(0.3, 1.0);
  search.step_m = random.uniform(0.05, 0.15);
  search.half_rad = random.uniform(0.1, 3.1);
  search.step_rad = random.uniform(0.05, 0.4);
  search.max_half_m = 1.5;
  search.starts = static_cast<std::int32_t>(1 + random.below(SmallestValues::kMost));
  search.attempts = static_cast<std::int32_t>(1 + random.below(3));
  scene.config.match.interpolation = random.below(2) == 0 ? Interpolation::kNearest : Interpolation::kBilinear;
  scene.config.prior.weight = random.below(2) == 0 ? 0.0 : 0.01;
  scene.points = points_of_scene(random, scene.config.map.resolution_m);
  scene.prediction = {.T_map_base = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)},
                      .travelled_m = 0.1,
                      .turned_rad = 0.1,
                      .by_odometry = random.below(2) == 0};
  return scene;
}

/// Bytes of the largest layer that the scene can come to; the points fit into as much.
std::size_t least_room(const Scene& scene) {
  MapperConfig widest = scene.config;
  widest.search.half_m = widest.search.max_half_m;
  return std::max(layer_bytes(widest), scene.points.size() * sizeof(PointCells));
}

TEST(WindowSlices, GiveWhatTheWindowInOnePieceGives) {
  std::ptrdiff_t sliced = 0;
  std::uint32_t windows = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = make_scene(seed);
    const Outcome whole = outcome_of(scene, 0);
    const Outcome layers = outcome_of(scene, least_room(scene));
    expect_equal(layers.result, whole.result);
    EXPECT_EQ(whole.count("lattice_minima"), whole.result.attempts);
    EXPECT_EQ(layers.count("pose_simplex"), whole.count("pose_simplex"));
    sliced += static_cast<std::ptrdiff_t>(whole.result.attempts) - layers.count("lattice_minima");
    windows += whole.result.attempts;
    if (HasFailure()) return;
  }
  EXPECT_GT(sliced, 150) << "too few were sliced";
  EXPECT_GT(windows, 200U) << "too few second windows";
}

// From the limit on at which a window fits it is one piece, in one submission; a byte less and it is cut.
TEST(WindowSlices, AreMadeOnlyWhereTheWindowDoesNotFit) {
  Scene scene = make_scene(2);
  scene.config.search.attempts = 1;
  MatchRules rules(scene.config);
  rules.begin(scene.prediction, scene.points.size());
  const SearchWindow window = rules.window(1.0);
  const std::uint32_t angles = window.count_theta();
  const std::size_t bytes = std::size_t{window.count_xy()} * window.count_xy() * angles * sizeof(PoseCandidate);
  ASSERT_GT(bytes, least_room(scene));
  const Outcome fits = outcome_of(scene, bytes);
  EXPECT_EQ(fits.count("pose_lattice"), 1);
  EXPECT_EQ(fits.count("flush"), 1);
  const Outcome cut = outcome_of(scene, bytes - 1);
  EXPECT_EQ(cut.count("pose_lattice"), static_cast<std::ptrdiff_t>(angles));
  EXPECT_EQ(cut.count("pose_cost"), static_cast<std::ptrdiff_t>(angles));
  EXPECT_EQ(cut.count("flush"), 2) << "one for the slices, one for what follows";
  EXPECT_EQ(cut.count("lattice_minima"), 0);
  expect_equal(cut.result, fits.result);
}

// More layers than one submission takes, and layers that are more than one submission by themselves.
TEST(WindowSlices, ComeInSeveralSubmissions) {
  Scene many = make_scene(1);
  many.config.search.half_m = 0.5;
  many.config.search.max_half_m = 0.5;
  many.config.search.step_m = 0.1;
  many.config.search.half_rad = 3.14;
  many.config.search.step_rad = 0.0005;
  many.config.search.attempts = 1;
  many.config.search.max_points = 8;
  Scene large = many;
  large.config.search.step_m = 0.00097;
  large.config.search.half_rad = 0.002;
  large.config.search.step_rad = 0.002;
  large.prediction.turned_rad = 0.0;
  for (const Scene& scene : {many, large}) {
    const Outcome layers = outcome_of(scene, least_room(scene));
    EXPECT_EQ(layers.count("lattice_minima"), 0);
    EXPECT_GE(layers.count("flush"), 3);
    const auto waited = std::find(layers.calls.begin(), layers.calls.end(), "finish_download");
    EXPECT_EQ(std::count(layers.calls.begin(), waited, "flush"), 2) << "the device must not wait for the host";
    expect_equal(layers.result, outcome_of(scene, 0).result);
  }
}

TEST(WindowSlices, AWindowWithTooManyPosesAtOneAngleIsRefusedAtTheStart) {
  Scene scene = make_scene(3);
  scene.prediction = {};
  const std::size_t least = least_room(scene);
  EXPECT_NO_THROW(outcome_of(scene, least));
  try {
    outcome_of(scene, least - 1);
    FAIL() << "nothing was thrown";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr(std::to_string(least) + " bytes, the largest allowed is "));
    EXPECT_THAT(error.what(), HasSubstr("search window"));
    EXPECT_THAT(error.what(), HasSubstr("raise search.step or lower search.max_half_width"));
  }
}

// A device that fails between two slices: the CPU goes on, which needs no slices.
TEST(WindowSlices, MayFailAtAnyCall) {
  MapperConfig config = test::quick_config(MatcherKind::kExhaustive);
  config.search.step_m = 0.1;
  config.search.step_rad = 0.003;
  config.search.max_points = 8;
  const auto scans = test::room_scans(4, 2);
  const auto cpu = make_cpu_backend({});
  const test::MappedDrive expected = test::map_drive(scans, config, *cpu);
  const std::size_t room = std::max(2 * (expected.cells.size() + expected.cells.size() / 4), layer_bytes(config));
  QueuedBackend whole;
  whole.set_max_buffer_bytes(room);
  const test::MappedDrive sliced = test::map_drive(scans, config, whole);
  expect_same(sliced, expected);
  EXPECT_EQ(sliced.loss, "");
  const auto& calls = whole.calls();
  ASSERT_EQ(std::count(calls.begin(), calls.end(), "lattice_minima"), 0) << "not sliced";
  const std::size_t first =
      static_cast<std::size_t>(std::find(calls.begin(), calls.end(), "pose_lattice") - calls.begin());
  for (std::size_t call = first; call <= calls.size(); call += 37) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + calls[call - 1]);
    QueuedBackend device(call);
    device.set_max_buffer_bytes(room);
    const test::MappedDrive found = test::map_drive(scans, config, device);
    expect_same(found, expected);
    EXPECT_EQ(found.warnings.size(), 1U);
    EXPECT_EQ(device.calls_after_failure(), 0U);
    if (HasFailure()) return;
  }
}

// The map itself is not cut: where it outgrows the device, the warning says what for and what to change.
TEST(WindowSlices, AMapBeyondTheLargestBufferIsNamed) {
  const MapperConfig config = test::quick_config(MatcherKind::kExhaustive);
  const auto scans = test::room_scans(24, 4);
  QueuedBackend device;
  device.set_max_buffer_bytes(100000);
  const test::MappedDrive found = test::map_drive(scans, config, device);
  EXPECT_THAT(found.loss, HasSubstr("for the map of "));
  EXPECT_THAT(found.loss, HasSubstr("a larger map.resolution makes it smaller, map.max_megacells="));
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings[0], HasSubstr("going on with the CPU"));
}

}  // namespace
}  // namespace gdtslam
