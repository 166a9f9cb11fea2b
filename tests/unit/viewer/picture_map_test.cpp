// The picture of a map: where things are, that nothing thin is lost, what the legend says.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/drawing/maps/path_layer.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/raster.hpp"
#include "picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace testing;

constexpr Colour kStart = colour_for(0x0a42d4);
constexpr Colour kEnd = colour_for(0xf5970f);
/// So small that the picture is the map alone, without words in the colour of walls.
constexpr PictureSize kBare{190, 150};

PathOverlay line_from(const Point2& from, const Point2& to) {
  PathOverlay overlay;
  overlay.trajectory = {{0.0, {from.x(), from.y(), 0.0}}, {1.0, {to.x(), to.y(), 0.0}}};
  return overlay;
}

/// A room of 12 x 8 cells of 10 cm; the middle of cell (0, 0) is at (-1.95, -0.95).
OccupancyMap room() {
  OccupancyMap map = free_map(12, 8);
  set_border(map);
  return map;
}

/// Where a single occupied cell darkens the picture of the room.
Point2 seen_at(CellIndex cell) {
  OccupancyMap map = room();
  const RgbaImage without = raster_of(map_picture(map, {}, {}, kBare));
  set(map, cell.x, cell.y, CellState::kOccupied);
  const RgbaImage with = raster_of(map_picture(map, {}, {}, kBare));
  Point2 sum = Point2::Zero();
  double count = 0.0;
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      if (brightness(without.at(x, y)) - brightness(with.at(x, y)) < 100.0) continue;
      sum += Point2(x + 0.5, y + 0.5);
      count += 1.0;
    }
  }
  EXPECT_GT(count, 50.0) << "squares of about 13 pixels";
  return sum / count;
}

/// Three cells give the map's place in the picture; a fourth cell and the path must agree with it.
TEST(MapPicture, cells_and_path_lie_where_three_known_cells_put_them) {
  const Point2 first = seen_at({1, 1});
  const Point2 per_cell_x = (seen_at({10, 1}) - first) / 9.0;
  const Point2 per_cell_y = (seen_at({1, 6}) - first) / 5.0;
  EXPECT_NEAR(per_cell_x.y(), 0.0, 0.02);
  EXPECT_NEAR(per_cell_y.x(), 0.0, 0.02);
  EXPECT_NEAR(per_cell_x.x(), -per_cell_y.y(), 0.35) << "y up, square cells";
  EXPECT_GT(per_cell_x.x(), 10.0);
  EXPECT_LT((first + 5.0 * per_cell_x + 3.0 * per_cell_y - seen_at({6, 4})).norm(), 0.6);

  const Point2 start{-1.63, -0.61};
  const Blob disc = blob_of(raster_of(map_picture(room(), line_from(start, {-1.2, -0.4}), {}, kBare)), kStart);
  ASSERT_GT(disc.pixels, 20U);
  const Point2 expected = first + (start.x() + 1.85) / 0.1 * per_cell_x + (start.y() + 0.85) / 0.1 * per_cell_y;
  EXPECT_LT((disc.centre - expected).norm(), 0.6) << disc.centre.transpose() << " for " << expected.transpose();
}

TEST(MapPicture, a_lone_cell_survives_ten_to_one) {
  OccupancyMap map = free_map(1500, 1500, 0.02);
  set_border(map);
  const RgbaImage without = raster_of(map_picture(map, {}, {}, kBare));
  set(map, 700, 903, CellState::kOccupied);
  const RgbaImage with = raster_of(map_picture(map, {}, {}, kBare));
  double darker = 0.0;
  int pixels = 0;
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      const double by = brightness(without.at(x, y)) - brightness(with.at(x, y));
      darker += by;
      if (by > 1.0) ++pixels;
    }
  }
  EXPECT_GE(darker, 90.0) << "of 218 that a wall is darker than free";
  EXPECT_GE(pixels, 1);
  EXPECT_LE(pixels, 4) << "a cell lies under at most four pixels";
}

/// A wall of one cell at 7.3 cells a pixel: no gap in it, wherever the borders of the pixels fall.
TEST(MapPicture, a_thin_wall_has_no_gaps) {
  OccupancyMap map = free_map(1100, 1100, 0.02);
  set_border(map);
  for (std::int32_t i = 100; i < 1000; ++i) set(map, i, i / 3 + 100, CellState::kOccupied);
  const RgbaImage image = raster_of(map_picture(map, {}, {}, kBare));
  const auto pixel_x = [](double cell) { return 95.0 + (cell - 550.0) / 7.6; };
  for (auto x = static_cast<std::uint32_t>(pixel_x(130)); x < pixel_x(970); ++x) {
    double darkest = 255.0;
    for (std::uint32_t y = 12; y + 12 < image.height; ++y) darkest = std::min(darkest, brightness(image.at(x, y)));
    EXPECT_LT(darkest, 150.0) << "column " << x;
  }
}

TEST(MapPicture, nothing_seen_is_still_a_picture) {
  OccupancyMap map;
  map.geometry = {0.05, 0.0, 0.0, 1, 1};
  map.cells = {CellState::kUnknown};
  for (const PictureSize size : {PictureSize{480, 270}, PictureSize{1, 1}, kBare}) {
    const RgbaImage image = raster_of(map_picture(map, {}, {}, size));
    EXPECT_EQ(image.width, size.width);
    EXPECT_EQ(image.height, size.height);
  }
}

/// The columns between which dark pixels lie.
struct DarkColumns {
  std::uint32_t first = 1000;
  std::uint32_t last = 0;
};
DarkColumns dark_columns(const RgbaImage& image) {
  DarkColumns columns;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (brightness(image.at(x, y)) > 100.0) continue;
      columns.first = std::min(columns.first, x);
      columns.last = std::max(columns.last, x);
    }
  }
  return columns;
}

/// A building of 40 x 20 m at (10, 20) within unknown land of 60 x 50 m.
OccupancyMap building() {
  OccupancyMap map = free_map(600, 500, 0.1, 0.0, 0.0);
  for (CellState& cell : map.cells) cell = CellState::kUnknown;
  for (std::int32_t y = 200; y < 400; ++y) {
    for (std::int32_t x = 100; x < 500; ++x) {
      const bool is_wall = x < 103 || x >= 497 || y < 203 || y >= 397;
      set(map, x, y, is_wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

/// The walls with a margin of 0.8 m, 3.7 pixels, at either side.
void expect_building_fills(const RgbaImage& image) {
  const DarkColumns columns = dark_columns(image);
  EXPECT_NEAR(columns.first, 3.7, 1.0);
  EXPECT_NEAR(columns.last + 1.0, 190.0 - 3.7, 1.0);
}

TEST(MapPicture, is_cropped_to_the_building_though_beams_leave_it) {
  OccupancyMap map = building();
  expect_building_fills(raster_of(map_picture(map, {}, {}, kBare)));
  // A fan of free cells to the edge of the grid, and one return.
  for (std::int32_t x = 500; x < 600; ++x) {
    for (std::int32_t y = 270; y < 330; ++y) set(map, x, y, CellState::kFree);
  }
  set(map, 599, 300, CellState::kOccupied);
  expect_building_fills(raster_of(map_picture(map, {}, {}, kBare)));
}

TEST(MapPicture, poses_of_no_sense_do_not_shrink_it) {
  PathOverlay overlay = line_from({30.0, 30.0}, {30.5, 30.0});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  overlay.trajectory.insert(overlay.trajectory.begin() + 1, {{0.2, {kNan, 4.0, 0.0}}, {0.4, {1e300, -1e300, 0.0}}});
  overlay.keyframes = overlay.doubtful = {1, 2};
  expect_building_fills(raster_of(map_picture(building(), overlay, {}, kBare)));
}

TEST(MapPicture, the_longest_legend_fits_a_narrow_picture) {
  PathOverlay overlay = line_from({-1.0, 0.0}, {1.0, 0.0});
  overlay.keyframes.assign(88888, 1);
  overlay.doubtful = overlay.keyframes;
  const RgbaImage image = raster_of(map_picture(free_map(40, 400), overlay, {}, {400, 1600}));
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = image.width - 6; x < image.width; ++x) ASSERT_GT(brightness(image.at(x, y)), 200.0) << y;
  }
}

TEST(MapPicture, transparent_where_nothing_is_known) {
  OccupancyMap map = two_rooms();
  MapLook look;
  look.is_transparent = true;
  const RgbaImage image = raster_of(map_picture(map, {}, look, kBare));
  EXPECT_EQ(image.at(0, 0)[3], 0) << "beyond the map";
  // The unknown corner is the last 14 of 64 columns and the upper 12 of 40 rows, at nearly 3 pixels a cell.
  EXPECT_EQ(image.at(175, 30)[3], 0) << "in the map, unknown";
  look.is_transparent = false;
  EXPECT_EQ(raster_of(map_picture(map, {}, look, kBare)).at(175, 30)[3], 255);
  EXPECT_EQ(image.at(kBare.width / 4, kBare.height / 2)[3], 255) << "free";
}

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

TEST(MapPicture, doubtful_scans_in_one_place_are_one_ring_with_their_number) {
  PathOverlay overlay = round_trip();
  for (int i = 0; i < 5; ++i) overlay.trajectory.push_back({60.0 + i, {1.0 + 0.001 * i, 1.0, 0.0}});
  overlay.doubtful = {5, 100, 101, 102, 103, 104};
  const auto words = shapes_of<shape::Words>(map_picture(two_rooms(), overlay, {}, {1600, 1200}));
  EXPECT_EQ(std::count_if(words.begin(), words.end(), [](const shape::Words& one) { return one.text == "5"; }), 1);
}

/// Length of the scale bar against the distance between start and end, which are 4 m apart.
TEST(MapPicture, scale_bar_is_as_long_as_it_says) {
  for (const PictureSize size : {PictureSize{480, 270}, PictureSize{1600, 1200}, PictureSize{1080, 1920}}) {
    const Canvas canvas = map_picture(two_rooms(), line_from({-1.0, 0.0}, {3.0, 0.0}), {}, size);
    Point2 start = Point2::Zero();
    Point2 end = Point2::Zero();
    bool has_start = false;
    for (const shape::Circle& circle : shapes_of<shape::Circle>(canvas)) {
      if (!has_start && circle.fill && circle.fill->colour == kStart) {
        start = circle.centre;
        has_start = true;
      } else if (has_start && end.isZero() && circle.edge && circle.edge->colour == kEnd) {
        end = circle.centre;
      }
    }
    const double px_per_m = (end - start).norm() / 4.0;
    bool is_found = false;
    for (const shape::Line& line : shapes_of<shape::Line>(canvas)) {
      if (line.points.size() != 4) continue;  // the bar with its two ends
      const double length_m = (line.points[2] - line.points[1]).norm() / px_per_m;
      is_found = true;
      const auto words = shapes_of<shape::Words>(canvas);
      const bool is_told = std::any_of(words.begin(), words.end(), [&](const shape::Words& one) {
        const double unit = one.text.ends_with(" cm") ? 0.01 : one.text.ends_with(" m") ? 1.0 : 0.0;
        return unit > 0.0 && std::fabs(unit * std::atof(one.text.c_str()) - length_m) < 1e-6;
      });
      EXPECT_TRUE(is_told) << length_m << " m";
    }
    EXPECT_TRUE(is_found);
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
