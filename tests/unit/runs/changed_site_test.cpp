// A site in which something went and something came after most of its scans: edits and tiles have both as merge found
// them.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/edits/edit_run.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/sites/merge_runs.hpp"
#include "engine/runs/tiles/map_tiles.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/map_files.hpp"
#include "ring_run.hpp"
#include "unit/back_end/loop_drive.hpp"

namespace gdtslam {
namespace {

constexpr double kBefore_s = 1000.0;
constexpr double kAfter_s = 90'000.0;

// Three times around; and a day later half around, where the last steps alone see what is new.
std::vector<Pose2> drive_before() { return test::poses_around_ring(3); }
std::vector<Pose2> drive_after() {
  const std::vector<Pose2> truth = test::poses_around_ring(1);
  return {truth.begin() + 30, truth.begin() + 196};
}

std::vector<test::Segment> rooms_with_box(const Point2& low, const Point2& high) {
  std::vector<test::Segment> walls = test::rooms_around_a_block();
  std::vector<test::Segment> box;
  test::add_box(box, low, high);
  const Pose2 turned{0.011, 0.007, 0.21};  // as the rooms are
  for (const test::Segment& wall : box) walls.push_back({turned * wall.from, turned * wall.to});
  return walls;
}

// Merged once for all tests of the process.
const JoinedSite& changed_site() {
  static const test::RunsFolder folder("changed-site");
  static const JoinedSite site = [] {
    const std::unique_ptr<Backend> cpu = make_cpu_backend({});
    const std::vector<test::Segment> before = rooms_with_box({5.6, -11.0}, {6.4, -10.5});
    const std::vector<test::Segment> after = rooms_with_box({5.0, 8.9}, {5.6, 9.6});
    test::write_drive_log(folder.path("before.log"), {before, kBefore_s}, drive_before(), 5);
    test::write_drive_log(folder.path("after.log"), {after, kAfter_s}, drive_after(), 77);
    MergeRequest request;
    for (const char* name : {"before", "after"}) {
      const std::string log = folder.path(std::string(name) + ".log");
      static_cast<void>(map_logs(test::ring_request(log, folder.path(name)), *cpu));
      request.runs.push_back(folder.path(name));
    }
    request.folder = folder.path("site");
    request.with_pictures = false;
    return merge_runs(request).sites.front();
  }();
  return site;
}

// Of cells that are walls in the site's map, and free where nothing but its scans is asked.
std::vector<Point2> centres_of_what_is_new() {
  const RunReader site(changed_site().folder);
  const Settings settings = site.settings();
  OccupancyBuilder builder(settings.occupancy, occupancy_limits(settings.mapper));
  const RunKeyframes kept = site.keyframes().value();
  for (const RunKeyframe& keyframe : kept.keyframes) builder.add(keyframe.laser, keyframe.T_map_base);
  const OccupancyMap cast = builder.build();
  const OccupancyMap map = site.map();
  std::vector<Point2> centres;
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      const Point2 centre = map.geometry.cell_centre({x, y});
      if (map.at({x, y}) == CellState::kOccupied && cast.at(cast.geometry.cell_at(centre)) == CellState::kFree) {
        centres.push_back(centre);
      }
    }
  }
  return centres;
}

EditRequest edit_of_site(const test::RunsFolder& folder) {
  EditRequest request;
  request.run = changed_site().folder;
  request.folder = folder.path("edited");
  request.with_pictures = false;
  return request;
}

bool has_wall_near(const OccupancyMap& map, const Point2& at_m, double within_m) {
  for (double x = -within_m; x <= within_m; x += map.geometry.resolution_m) {
    for (double y = -within_m; y <= within_m; y += map.geometry.resolution_m) {
      const CellIndex cell = map.geometry.cell_at(at_m + Point2(x, y));
      if (map.geometry.contains(cell) && map.at(cell) == CellState::kOccupied) return true;
    }
  }
  return false;
}

TEST(ChangedSite, HasWallsThatMostScansSawThrough) {
  EXPECT_FALSE(changed_site().changes.last.gone.empty());
  EXPECT_GT(changed_site().changes.readings, 0U);
  EXPECT_GE(centres_of_what_is_new().size(), 5U);
}

TEST(ChangedSite, KeepsWhatIsNewInAnotherFrame) {
  const test::RunsFolder folder("changed-turn");
  EditRequest request = edit_of_site(folder);
  request.origin = StatedOrigin{{1.0, -2.0, 0.7}, true};
  const EditOutcome outcome = edit_run(request);
  const OccupancyMap map = RunReader(request.folder).map();
  std::size_t missing = 0;
  const std::vector<Point2> centres = centres_of_what_is_new();
  std::size_t moved = 0;
  for (const Point2& centre : centres) {
    const Point2 edited = outcome.plan.T_edited_run * centre;
    moved += has_wall_near(map, edited, 0.05) ? 0U : 1U;
    missing += has_wall_near(map, edited, 0.1) ? 0U : 1U;
  }
  EXPECT_EQ(missing, 0U) << "of " << centres.size();
  EXPECT_LE(10 * moved, centres.size()) << "where a wall ends is a matter of two cells";
}

TEST(ChangedSite, HasTilesWithWhatIsNew) {
  const test::RunsFolder folder("changed-tiles");
  EditRequest request = edit_of_site(folder);
  request.with_tiles = true;
  static_cast<void>(edit_run(request));
  const OccupancyMap map = RunReader(request.folder).map();
  std::size_t walls = 0;
  std::size_t known = 0;
  for (const auto& entry : std::filesystem::directory_iterator(request.folder + "/tiles")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("map_") || !name.ends_with(".yaml")) continue;
    const OccupancyMap tile = read_occupancy_map(entry.path().string());
    for (std::int32_t y = 0; y < kMapTileSide; ++y) {
      for (std::int32_t x = 0; x < kMapTileSide; ++x) {
        if (tile.at({x, y}) == CellState::kUnknown) continue;
        ++known;
        walls += tile.at({x, y}) == CellState::kOccupied ? 1U : 0U;
        ASSERT_EQ(tile.at({x, y}), map.at(map.geometry.cell_at(tile.geometry.cell_centre({x, y}))));
      }
    }
  }
  std::size_t walls_of_map = 0;
  std::size_t known_of_map = 0;
  for (const CellState state : map.cells.all()) {
    walls_of_map += state == CellState::kOccupied ? 1U : 0U;
    known_of_map += state == CellState::kUnknown ? 0U : 1U;
  }
  EXPECT_EQ(walls, walls_of_map);
  EXPECT_EQ(known, known_of_map);
}

}  // namespace
}  // namespace gdtslam
