// A run that is edited: where its poses, cells and readings come to lie, by hand from the drive that is known.
#include "engine/runs/edits/edit_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/edits/edit_steps.hpp"
#include "engine/runs/edits/source_run.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using test::ring_run;
using testing::HasSubstr;

EditRequest edit_into(const test::RunsFolder& folder, const std::string& name = "edited") {
  EditRequest request;
  request.run = ring_run().folder;
  request.folder = folder.path(name);
  request.with_pictures = false;
  return request;
}

std::string edit_fault(const EditRequest& request) {
  try {
    static_cast<void>(edit_run(request));
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(EditedRun, AStatedOriginTurnsAndShiftsAllOfIt) {
  const test::RunsFolder folder("edit-origin");
  EditRequest request = edit_into(folder);
  request.origin = StatedOrigin{{1.0, -2.0, 0.5 * kPi}, true};
  const EditOutcome outcome = edit_run(request);
  EXPECT_EQ(outcome.readings, 0U);
  EXPECT_EQ(outcome.scans, ring_run().truth.size());
  EXPECT_FALSE(outcome.is_of_keyframes);
  const Trajectory was = read_tum(ring_run().folder + "/trajectory.tum");
  const Trajectory is = read_tum(request.folder + "/trajectory.tum");
  ASSERT_EQ(is.size(), was.size());
  for (std::size_t k = 0; k < is.size(); k += 17) {  // x grows to the left of the new axis
    EXPECT_NEAR(is[k].T_map_base.x_m, was[k].T_map_base.y_m + 2.0, 2e-5);
    EXPECT_NEAR(is[k].T_map_base.y_m, 1.0 - was[k].T_map_base.x_m, 2e-5);
    EXPECT_NEAR(wrap_angle(is[k].T_map_base.theta_rad - was[k].T_map_base.theta_rad + 0.5 * kPi), 0.0, 2e-5);
  }
  const ordered_json report = ordered_json::parse(test::text_of_file(request.folder + "/report.json"));
  EXPECT_EQ(report.at("edited").at("run"), request.run);
  EXPECT_NEAR(report.at("edited").at("T_edited_run").at(0).get<double>(), 2.0, 1e-9);
  EXPECT_NEAR(report.at("edited").at("T_edited_run").at(1).get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(report.at("edited").at("T_edited_run").at(2).get<double>(), -0.5 * kPi, 1e-9);
  // Turned by a quarter the map is as high as it was wide, but for what a cell rounds.
  const OccupancyMap old_map = RunReader(ring_run().folder).map();
  const OccupancyMap new_map = RunReader(request.folder).map();
  EXPECT_NEAR(new_map.geometry.width, old_map.geometry.height, 2);
  EXPECT_NEAR(new_map.geometry.height, old_map.geometry.width, 2);
  for (const StampedPose& pose : is)
    EXPECT_EQ(new_map.at(new_map.geometry.cell_of(pose.T_map_base.translation())), CellState::kFree);
  const SourceRun edited = read_source_run(request.folder);
  ASSERT_TRUE(edited.earlier);
  EXPECT_EQ(edited.earlier->begins_at_s, 1000.0);
  EXPECT_FALSE(fs::exists(request.folder + "/continue.json")) << "its log has no place in it";
  EXPECT_THAT(outcome.edits, HasSubstr("\"readings"));
}

TEST(EditedRun, TheSameStepsAgainGiveTheSameBytes) {
  const test::RunsFolder folder("edit-again");
  EditRequest request = edit_into(folder, "first");
  request.origin = StatedOrigin{{0.5, 0.25, 0.3}, true};
  static_cast<void>(edit_run(request));
  EditRequest again = edit_into(folder, "second");
  again.again = request.folder + "/edits.json";
  EXPECT_EQ(edit_run(again).steps.size(), 1U);
  for (const char* name : {"trajectory.tum", "map.pgm", "gdt.png", "covariance.csv", "graph.g2o"}) {
    EXPECT_EQ(test::text_of_file(folder.path("first/") + name), test::text_of_file(folder.path("second/") + name))
        << name;
  }
  again.run = request.folder;
  again.folder = folder.path("third");
  EXPECT_THAT(edit_fault(again), HasSubstr("was edited already: --again takes the run before its edits"));
  std::string text = test::text_of_file(folder.path("first/edits.json"));
  const std::size_t at = text.find("1000");
  ASSERT_NE(at, std::string::npos);
  std::ofstream(folder.path("other.json")) << text.replace(at, 4, "1001");
  again = edit_into(folder, "fourth");
  again.again = folder.path("other.json");
  EXPECT_THAT(edit_fault(again), HasSubstr("is of a run that begins at 1001.000 s"));
}

TEST(EditedRun, ACropLeavesTheCellsWithinAndNoOther) {
  const test::RunsFolder folder("edit-crop");
  EditRequest request = edit_into(folder);
  request.crop = RegionBounds{{-2.0, -3.0}, {6.0, 1.0}};
  const EditOutcome outcome = edit_run(request);
  EXPECT_EQ(outcome.scans, 0U) << "its cells are those of the run";
  const OccupancyMap was = RunReader(request.run).map();
  const OccupancyMap is = RunReader(request.folder).map();
  EXPECT_GE(is.geometry.origin_x_m, -2.0 - 0.0126);
  EXPECT_GE(is.geometry.origin_y_m, -3.0 - 0.0126);
  EXPECT_LE(is.geometry.origin_x_m + is.geometry.width * 0.025, 6.0 + 0.0126);
  EXPECT_LE(is.geometry.origin_y_m + is.geometry.height * 0.025, 1.0 + 0.0126);
  std::size_t known = 0;
  for (std::int32_t y = 0; y < is.geometry.height; ++y) {
    for (std::int32_t x = 0; x < is.geometry.width; ++x) {
      const CellIndex there = was.geometry.cell_of(is.geometry.centre_of({x, y}));
      ASSERT_EQ(is.at({x, y}), was.at(there));
      known += is.at({x, y}) == CellState::kUnknown ? 0U : 1U;
    }
  }
  EXPECT_GT(known, 1000U);
  // A reading counts where its beam ends outside: by hand from the keyframes.
  std::uint64_t outside = 0;
  const RunKeyframes kept = RunReader(request.run).keyframes().value();
  for (const RunKeyframe& keyframe : kept.keyframes) {
    for (std::size_t beam = 0; beam < keyframe.laser.ranges_m.size(); ++beam) {
      const auto range_m = static_cast<double>(keyframe.laser.ranges_m[beam]);
      if (!(range_m >= 0.1 && range_m < 40.0)) continue;
      const double bearing =
          keyframe.laser.first_bearing_rad + static_cast<double>(beam) * keyframe.laser.bearing_step_rad;
      const Point2 end = keyframe.T_map_base * Point2(range_m * std::cos(bearing), range_m * std::sin(bearing));
      const bool is_within = end.x() > -2.0 && end.x() < 6.0 && end.y() > -3.0 && end.y() < 1.0;
      outside += is_within ? 0U : 1U;
    }
  }
  EXPECT_EQ(outcome.readings, outside);
  request.folder = folder.path("nothing");
  request.crop = RegionBounds{{500.0, 500.0}, {501.0, 501.0}};
  EXPECT_THAT(edit_fault(request), HasSubstr("--crop leaves nothing"));
}

TEST(EditedRun, WhatIsErasedIsSeenThrough) {
  const test::RunsFolder folder("edit-erase");
  EditRequest request = edit_into(folder);
  // A metre of the block's wall, which is 1 m to the left of where the drive began.
  request.erased = {rectangle_between({1.0, 0.7}, {2.0, 1.3})};
  const EditOutcome outcome = edit_run(request);
  EXPECT_GT(outcome.readings, 0U);
  EXPECT_EQ(outcome.scans, ring_run().truth.size());
  const OccupancyMap was = RunReader(request.run).map();
  const OccupancyMap is = RunReader(request.folder).map();
  const auto occupied_in = [](const OccupancyMap& map, const Point2& low, const Point2& high) {
    std::size_t count = 0;
    for (double x = low.x(); x < high.x(); x += 0.025) {
      for (double y = low.y(); y < high.y(); y += 0.025) {
        const CellIndex cell = map.geometry.cell_of({x, y});
        count += map.geometry.contains(cell) && map.at(cell) == CellState::kOccupied ? 1U : 0U;
      }
    }
    return count;
  };
  EXPECT_GE(occupied_in(was, {1.1, 0.8}, {1.9, 1.2}), 20U);
  EXPECT_EQ(occupied_in(is, {1.1, 0.8}, {1.9, 1.2}), 0U);
  EXPECT_GE(occupied_in(is, {3.0, 0.8}, {3.8, 1.2}), 20U) << "the wall beside it stays";
}

TEST(EditedRun, PointsOfTheWorldAndAPictureForAGis) {
  const test::RunsFolder folder("edit-world");
  EditRequest request = edit_into(folder);
  // A quarter turn to the left and a shift, from two points 10 m apart.
  request.points = {{{0.0, 0.0}, {1000.0, 2000.0}}, {{10.0, 0.0}, {1000.0, 2010.0}}};
  request.with_world_file = true;
  const EditOutcome outcome = edit_run(request);
  ASSERT_TRUE(outcome.plan.T_world_edited);
  EXPECT_NEAR(outcome.plan.T_world_edited->x_m, 1000.0, 1e-9);
  EXPECT_NEAR(outcome.plan.T_world_edited->y_m, 2000.0, 1e-9);
  EXPECT_NEAR(outcome.plan.T_world_edited->theta_rad, 0.5 * kPi, 1e-9);
  EXPECT_EQ(outcome.scans, 0U) << "its cells are those of the run";
  EXPECT_TRUE(fs::exists(request.folder + "/map.png") && fs::exists(request.folder + "/map.pgw"));
  request.folder = folder.path("north");
  request.north_up = true;
  const EditOutcome north = edit_run(request);
  EXPECT_NEAR(north.plan.T_world_edited->theta_rad, 0.0, 1e-9);
  EXPECT_NEAR(north.plan.T_edited_run.theta_rad, 0.5 * kPi, 1e-9);
  request.folder = folder.path("no-points");
  request.points.clear();
  EXPECT_THAT(edit_fault(request), HasSubstr("--north-up: nothing says where north is"));
  fs::create_directories(folder.path("foreign"));
  std::ofstream(folder.path("foreign/map.png")) << "mine";
  request = edit_into(folder, "foreign");
  request.with_world_file = true;
  EXPECT_THAT(edit_fault(request), HasSubstr("holds a map.png that no run wrote"));
  EXPECT_EQ(test::text_of_file(folder.path("foreign/map.png")), "mine");
}

// The walls of the corridor and the drive's first heading are both turned by 0.21 rad: in the map they lie along x.
TEST(EditedRun, AlongItsWalls) {
  const test::RunsFolder folder("edit-walls");
  EditRequest request = edit_into(folder, "turned");
  request.origin = StatedOrigin{{0.0, 0.0, -0.3}, true};
  static_cast<void>(edit_run(request));
  request = edit_into(folder);
  request.run = folder.path("turned");  // in whose frame walls run at 0.3 rad
  request.along_walls = true;
  const EditOutcome outcome = edit_run(request);
  EXPECT_NEAR(outcome.plan.T_edited_run.theta_rad, -0.3, 0.01) << "beside the first step";
  EXPECT_TRUE(outcome.is_of_keyframes) << "what was edited names no log";
  const Trajectory is = read_tum(request.folder + "/trajectory.tum");
  EXPECT_NEAR(is[20].T_map_base.theta_rad, 0.0, 0.01);
}

TEST(EditedRun, StepsThatMakeNoSenseTogether) {
  const test::RunsFolder folder("edit-faults");
  EXPECT_THAT(edit_fault(edit_into(folder)), HasSubstr("nothing is to be done: name a step"));
  EditRequest request = edit_into(folder);
  request.along_walls = true;
  request.north_up = true;
  EXPECT_THAT(edit_fault(request), HasSubstr("give one of them"));
  request.north_up = false;
  request.origin = StatedOrigin{{0.0, 0.0, 0.1}, true};
  EXPECT_THAT(edit_fault(request), HasSubstr("its THETA turns the map, and so does --rotate-to-walls"));
  request.along_walls = false;
  request.north_up = true;
  EXPECT_THAT(edit_fault(request), HasSubstr("its THETA turns the map, and so does --north-up"));
  request = edit_into(folder);
  request.folder = request.run;
  request.origin = StatedOrigin{{0.0, 0.0, 0.1}, true};
  EXPECT_THAT(edit_fault(request), HasSubstr("is the run itself"));
  // The first scan lies in the origin, so these put it 10 km away and one metre beyond.
  request = edit_into(folder);
  request.origin = StatedOrigin{{10040.0, 0.0, 0.0}, false};
  EXPECT_THAT(edit_fault(request), HasSubstr("m from its origin, and 10000 m is the most"));
  request.origin = StatedOrigin{{0.0, 10040.0, 0.0}, false};
  EXPECT_THAT(edit_fault(request), HasSubstr("m from its origin, and 10000 m is the most"));
  EXPECT_FALSE(fs::exists(request.folder));
}

// Of a run that went farther than a map may be moved what the edit does counts, not where the run is.
TEST(EditedRun, ARunThatGoesFarMayBeEdited) {
  const test::RunsFolder folder("edit-far");
  SourceRun run = read_source_run(ring_run().folder);
  move_to_frame({15000.0, 2000.0, 0.0}, run);
  EditRequest request = edit_into(folder);
  request.crop = RegionBounds{{14990.0, 1990.0}, {15010.0, 2010.0}};
  EXPECT_EQ(resolved_steps(request, run).size(), 1U);
  request.origin = StatedOrigin{{0.0, 0.0, 0.5}, true};
  EXPECT_EQ(resolved_steps(request, run).size(), 2U) << "turned it is as far as before";
  request.origin = StatedOrigin{{3000.0, 0.0, 0.0}, false};
  EXPECT_EQ(resolved_steps(request, run).size(), 2U) << "it comes nearer";
  request.origin = StatedOrigin{{-100.0, 0.0, 0.0}, false};
  EXPECT_THROW(static_cast<void>(resolved_steps(request, run)), UsageError);
}

TEST(EditedRun, AStopLeavesNothing) {
  const test::RunsFolder folder("edit-stop");
  EditRequest request = edit_into(folder);
  request.origin = StatedOrigin{{0.0, 1.0, 0.0}, false};
  std::vector<std::string> steps;
  request.progress = [&](std::string_view step, double share) {
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    steps.emplace_back(step);
  };
  request.stop = [&] { return steps.size() > 3; };
  EXPECT_THAT(edit_fault(request), HasSubstr("interrupted; nothing was written"));
  EXPECT_FALSE(fs::exists(request.folder + "/report.json"));
}

}  // namespace
}  // namespace gdtslam
