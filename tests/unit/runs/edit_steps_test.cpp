// Steps of an edit: what they come to, what is taken out, and edits.json.
#include "engine/runs/edits/edit_steps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

constexpr double kQuarter = kPi / 2;

void expect_near(const Point2& a, const Point2& b) {
  EXPECT_NEAR(a.x(), b.x(), 1e-9);
  EXPECT_NEAR(a.y(), b.y(), 1e-9);
}

TEST(EditPlan, FollowsPointsThroughEveryFrame) {
  // The origin to (2, 1) with x along the old y; then to (1, 0) of that, turned back.
  const std::vector<EditStep> steps{EraseEdit{{{{3, 1}, {4, 1}, {4, 2}}}},
                                    FrameEdit{.T_before_after = {2, 1, kQuarter}}, CropEdit{{-1, -1}, {5, 5}},
                                    FrameEdit{.T_before_after = {1, 0, -kQuarter}}};
  const EditPlan plan = combine_steps(steps);
  ASSERT_TRUE(plan.has_other_frame);
  // (3, 1) is (0, -1) after the first, so one to the right of and one below (1, 0), whose x axis points down -y.
  expect_near(plan.erased.at(0).corners_m.at(0), {1.0, -1.0});
  expect_near(plan.T_edited_run * Point2(3, 1), {1.0, -1.0});
  // The crop is in the second frame: its corner (5, 5) is 4 to the right and 5 up of (1, 0).
  expect_near(plan.kept.at(0).corners_m.at(2), {-5.0, 4.0});
  EXPECT_NEAR(std::remainder(plan.T_edited_run.theta_rad, kTwoPi), 0.0, 1e-12);
}

TEST(EditPlan, KeepsTheWorldWhereItIs) {
  GeoreferenceEdit world{{}, {.T_world_map = {1000, 2000, 0.3}}};
  const EditPlan before = combine_steps({world});
  const EditPlan after = combine_steps({FrameEdit{.T_before_after = {5, -2, 1.1}}, WorldFileEdit{}}, before);
  ASSERT_TRUE(after.T_world_edited && after.with_world_file);
  const Point2 place{7.5, 3.25};
  expect_near(*after.T_world_edited * (after.T_edited_run * place), Pose2{1000, 2000, 0.3} * place);
}

TEST(EditPlan, AnOriginWhereItWasIsNoOtherFrame) {
  EXPECT_FALSE(combine_steps({FrameEdit{}}).has_other_frame);
  EXPECT_TRUE(combine_steps({FrameEdit{.T_before_after = {0, 0, 1e-9}}}).has_other_frame);
}

// An L; and against the sum of the angles at which its sides are seen, which is a whole turn inside.
TEST(MapRegion, ContainsWhatItsOutlineGoesAround) {
  const MapRegion region{{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}};
  const auto turns = [&region](const Point2& p) {
    double sum = 0.0;
    for (std::size_t k = 0; k < region.corners_m.size(); ++k) {
      const Point2 a = region.corners_m[k] - p;
      const Point2 b = region.corners_m[(k + 1) % region.corners_m.size()] - p;
      sum += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    return std::fabs(sum) > kPi;
  };
  Random random(3);
  int inside = 0;
  for (int k = 0; k < 5000; ++k) {
    const Point2 p{random.uniform(-1.0, 5.0), random.uniform(-1.0, 4.0)};
    ASSERT_EQ(region.contains(p), turns(p)) << p.transpose();
    inside += region.contains(p) ? 1 : 0;
  }
  EXPECT_NEAR(inside / 5000.0, 6.0 / 30.0, 0.03);
}

TEST(MapRegion, SidesOfNeighboursBelongToOneOfThem) {
  const MapRegion left = rectangle_between({0, 0}, {1, 1});
  const MapRegion right = rectangle_between({1, 0}, {2, 1});
  for (const double y : {0.0, 0.25, 0.5}) EXPECT_NE(left.contains({1, y}), right.contains({1, y}));
}

// Beams every 90 degrees from (1, 1), looking along y.
TEST(TakenOut, ReadingsGoByWhereTheyEnd) {
  LaserScan scan;
  scan.first_bearing_rad = -kQuarter;
  scan.bearing_step_rad = kQuarter;
  scan.max_range_m = 10.0;
  scan.ranges_m = {2.0F, 3.0F, 4.0F, 10.0F};  // ends at (3, 1), (1, 4), (-3, 1); no return
  const std::vector<MapRegion> erased{rectangle_between({0, 3.5}, {2, 4.5})};
  const std::vector<MapRegion> kept{rectangle_between({0, 0}, {5, 5})};
  const Pose2 T{1, 1, kQuarter};
  LaserScan less = scan;
  EXPECT_EQ(take_out_readings({.erased = erased}, {}, T, less), 1U);
  EXPECT_TRUE(std::isinf(less.ranges_m[1]));
  EXPECT_EQ(less.ranges_m[0], 2.0F);
  less = scan;
  EXPECT_EQ(take_out_readings({.kept = kept}, {}, T, less), 1U);
  EXPECT_TRUE(std::isinf(less.ranges_m[2]));
  EXPECT_EQ(less.ranges_m[3], 10.0F);
  less = scan;
  EXPECT_EQ(take_out_readings({erased, kept}, {}, T, less), 2U);
}

OccupancyMap chequered(std::int32_t width, std::int32_t height) {
  OccupancyMap map{{.resolution_m = 0.5, .origin_x_m = -2.0, .origin_y_m = 1.0, .width = width, .height = height},
                   CellStates(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  for (std::size_t k = 0; k < map.cells.size(); ++k) map.cells.set(k, static_cast<CellState>(k * k % 3));
  return map;
}

TEST(TakenOut, CropsToCellsWhoseCentresAreInside) {
  const OccupancyMap map = chequered(12, 9);
  const OccupancyMap part = cropped(map, {rectangle_between({-1.0, 1.6}, {1.3, 100.0})});
  // Columns from -1.0 on whose centre is below 1.3: -0.75, ..., 1.25; rows with centres 1.75 and above.
  EXPECT_EQ(part.geometry,
            (GridGeometry{.resolution_m = 0.5, .origin_x_m = -1.0, .origin_y_m = 1.5, .width = 5, .height = 8}));
  for (std::int32_t y = 0; y < 8; ++y) {
    for (std::int32_t x = 0; x < 5; ++x) EXPECT_EQ(part.at({x, y}), map.at({x + 2, y + 1}));
  }
  EXPECT_THROW((void)cropped(map, {rectangle_between({50, 50}, {60, 60})}), InputError);
  EXPECT_THROW((void)cropped(map, {rectangle_between({-50, -50}, {-40, -40})}), InputError);
  EXPECT_EQ(cropped(map, {}).geometry, map.geometry);
}

TEST(TakenOut, OutsideOfASlantedCropIsUnknown) {
  OccupancyMap map = chequered(20, 20);
  for (std::size_t k = 0; k < map.cells.size(); ++k) map.cells.set(k, CellState::kFree);
  const MapRegion diamond{{{3, 2}, {5, 4}, {3, 6}, {1, 4}}};
  const OccupancyMap part = cropped(map, {diamond});
  for (std::int32_t y = 0; y < part.geometry.height; ++y) {
    for (std::int32_t x = 0; x < part.geometry.width; ++x) {
      const Point2 c = part.geometry.cell_centre({x, y});
      const double away = std::fabs(c.x() - 3) + std::fabs(c.y() - 4);
      if (std::fabs(away - 2) < 1e-6) continue;
      EXPECT_EQ(part.at({x, y}), away < 2 ? CellState::kFree : CellState::kUnknown);
    }
  }
}

TEST(EditsFile, ReadsBackWhatItWrote) {
  GeoreferenceEdit world{{{{0.1, 0.2}, {455012.25, 5411930.5}}, {{30, 7}, {455042, 5411931}}}, {}};
  world.fit = {
      .T_world_map = {455012.1, 5411930.3, 0.123456789012345}, .scale = 1.01, .rms_m = 0.2, .residuals_m = {0.2, 0.2}};
  const RecordedEdits edits{
      .run = "a \"run\"\n",
      .begins_at_s = 1234567890.123456,
      .steps = {world,
                FrameEdit{.by = FrameEdit::By::kWalls, .T_before_after = {0.1, -0.3, 1.0 / 3.0}, .walls_share = 0.6},
                EraseEdit{{{{1, 2}, {3, 4}, {5, 1.0 / 7.0}}}}, CropEdit{{-1, -2}, {3, 4}}, WorldFileEdit{}}};
  const std::string text = edits_text(edits, 17);
  const RecordedEdits read = parse_edits(text, "edits.json");
  EXPECT_EQ(edits_text(read, 17), text);
  EXPECT_EQ(std::get<FrameEdit>(read.steps[1]).T_before_after, (Pose2{0.1, -0.3, 1.0 / 3.0}));
  EXPECT_THAT(text, HasSubstr("\"readings_taken_out\": 17"));
}

}  // namespace
}  // namespace gdtslam
