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
      const CellIndex there = was.geometry.cell_at(is.geometry.cell_centre({x, y}));
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
        const CellIndex cell = map.geometry.cell_at({x, y});
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

}  // namespace
}  // namespace gdtslam
