// The pixels of a map's picture: where things are, that nothing thin is lost. Its shapes: unit/drawing.
#include <limits>

#include <gtest/gtest.h>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

/// So small that the picture is the map alone, without words in the colour of walls.
constexpr PictureSize kBareMap{190, 150};

/// A room of 12 x 8 cells of 10 cm; the middle of cell (0, 0) is at (-1.95, -0.95).
OccupancyMap room() {
  OccupancyMap map = free_map(12, 8);
  set_border(map);
  return map;
}

/// Where a single occupied cell darkens the picture of the room.
Point2 seen_at(CellIndex cell) {
  OccupancyMap map = room();
  const RgbaImage without = rasterise(map_picture(map, {}, {}, kBareMap));
  set(map, cell.x, cell.y, CellState::kOccupied);
  const RgbaImage with = rasterise(map_picture(map, {}, {}, kBareMap));
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
  const Blob disc =
      blob_of(rasterise(map_picture(room(), straight_path(start, {-1.2, -0.4}), {}, kBareMap)), kPathStart);
  ASSERT_GT(disc.pixels, 20U);
  const Point2 expected = first + (start.x() + 1.85) / 0.1 * per_cell_x + (start.y() + 0.85) / 0.1 * per_cell_y;
  EXPECT_LT((disc.centre - expected).norm(), 0.6) << disc.centre.transpose() << " for " << expected.transpose();
}

TEST(MapPicture, a_lone_cell_survives_ten_to_one) {
  OccupancyMap map = free_map(1500, 1500, 0.02);
  set_border(map);
  const RgbaImage without = rasterise(map_picture(map, {}, {}, kBareMap));
  set(map, 700, 903, CellState::kOccupied);
  const RgbaImage with = rasterise(map_picture(map, {}, {}, kBareMap));
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

TEST(MapPicture, nothing_seen_is_still_a_picture) {
  OccupancyMap map;
  map.geometry = {0.05, 0.0, 0.0, 1, 1};
  map.cells = CellStates(1);
  for (const PictureSize size : {PictureSize{480, 270}, PictureSize{1, 1}, kBareMap}) {
    const RgbaImage image = rasterise(map_picture(map, {}, {}, size));
    EXPECT_EQ(image.width, size.width);
    EXPECT_EQ(image.height, size.height);
  }
}

TEST(MapPicture, poses_of_no_sense_do_not_shrink_it) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  PathOverlay overlay = straight_path({-1.6, -0.6}, {-1.3, -0.6});
  overlay.trajectory.insert(overlay.trajectory.begin() + 1, {{0.2, {kNan, 4.0, 0.0}}, {0.4, {1e300, -1e300, 0.0}}});
  overlay.keyframes = overlay.doubtful = {1, 2};
  const RgbaImage with = rasterise(map_picture(room(), overlay, {}, kBareMap));
  const RgbaImage without = rasterise(map_picture(room(), {}, {}, kBareMap));
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      if (brightness(without.at(x, y)) > 100.0) continue;
      EXPECT_LE(brightness(with.at(x, y)), 100.0) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace gdtslam
