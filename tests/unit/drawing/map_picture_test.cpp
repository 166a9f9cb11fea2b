// The picture of a map as shapes, without pixels: what the legend says, its scale, the path.
#include "gdtslam/drawing/map_picture.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/drawing/maps/map_sheet.hpp"
#include "engine/drawing/maps/path_layer.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

TEST(MapPicture, indices_beyond_the_trajectory_are_refused) {
  PathOverlay overlay = round_trip();
  overlay.doubtful.push_back(overlay.trajectory.size());
  EXPECT_THROW(map_picture(two_rooms(), overlay, {}, {}), InputError);
  overlay = round_trip();
  overlay.keyframes.push_back(1000000);
  EXPECT_THROW(map_picture(two_rooms(), overlay, {}, {}), InputError);
}

TEST(MapPicture, legend_counts) {
  PathOverlay overlay = round_trip();
  MapLook look;
  look.title = "Two rooms";
  Canvas canvas = map_picture(two_rooms(), overlay, look, {1600, 1200});
  EXPECT_TRUE(says(canvas, "Two rooms"));
  EXPECT_TRUE(says(canvas, "10 keyframes"));
  EXPECT_TRUE(says(canvas, "2 doubtful scans"));
  EXPECT_TRUE(says(canvas, "after 50 s")) << "100 poses half a second apart";
  overlay.doubtful = {3};
  overlay.keyframes.clear();
  canvas = map_picture(two_rooms(), overlay, look, {1600, 1200});
  EXPECT_TRUE(says(canvas, "1 doubtful scan"));
  EXPECT_FALSE(says(canvas, "doubtful scans"));
  EXPECT_FALSE(says(canvas, "keyframe"));
}

/// The map's place depends on the legend's rows, and the scale bar in the legend on the map's scale.
TEST(MapPicture, legends_are_made_for_the_scale_that_is_drawn) {
  Random random(20);
  for (int round = 0; round < 3000; ++round) {
    const PictureSize size{200 + static_cast<std::uint32_t>(random.below(700)),
                           200 + static_cast<std::uint32_t>(random.below(700))};
    const picture::MapArea area{0.0, 0.0, random.uniform(0.5, 60.0), random.uniform(0.5, 60.0)};
    const picture::LegendLook legend{kLightTheme, picture::picture_proportions(size)};
    double px_per_m = 0.0;
    const picture::Sheet sheet = picture::lay_out_sheet(area, {}, size, kLightTheme, [&](double scale) {
      px_per_m = scale;
      return std::vector{picture::scale_bar_item(scale, legend), picture::axes_item(legend),
                         picture::swatch_item("never observed", ink::kText, legend),
                         picture::swatch_item("occupied", ink::kText, legend)};
    });
    ASSERT_EQ(sheet.frame.px_per_m, px_per_m) << size.width << "x" << size.height << ", round " << round;
    const picture::Panel& panel = sheet.frame.panel;
    for (const Point2& corner : {Point2(area.min_x_m, area.min_y_m), Point2(area.max_x_m, area.max_y_m)}) {
      const Point2 at = sheet.frame.to_pixel(corner) - Point2(panel.left_px, panel.top_px);
      EXPECT_GE(at.minCoeff(), -1e-6) << "round " << round;
      EXPECT_LE(at.x(), panel.width_px + 1e-6) << "round " << round;
      EXPECT_LE(at.y(), panel.height_px + 1e-6) << "round " << round;
    }
  }
}

/// A standing robot must not fill the drawing.
TEST(MapPicture, a_robot_that_stands_costs_nothing) {
  PathOverlay overlay = round_trip();
  for (int i = 0; i < 100000; ++i) overlay.trajectory.push_back({60.0 + i, {1.0, 1.0, 0.0}});
  std::size_t points = 0;
  for (const shape::Line& line : shapes_of<shape::Line>(map_picture(two_rooms(), overlay, {}, {1600, 1200}))) {
    points += line.points.size();
  }
  EXPECT_LT(points, 1000U);
}

TEST(PathTime, never_falls_though_stamps_do) {
  Trajectory trajectory;
  for (const double stamp_s : {10.0, 12.0, 11.0, 14.0, 13.0}) trajectory.push_back({stamp_s, {}});
  EXPECT_EQ(picture::time_shares(trajectory), (std::vector<double>{0.0, 0.5, 0.5, 1.0, 1.0}));
  for (StampedPose& pose : trajectory) pose.stamp_s = 5.0;
  EXPECT_EQ(picture::time_shares(trajectory), (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0})) << "order, not stamps";
}

}  // namespace
}  // namespace gdtslam
