// The path over a map: what can be drawn of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <variant>
#include <vector>

#include "engine/drawing/maps/path_layer.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {
namespace {

// Cairo's coordinates wrap at 2^23 pixels, so that a line to a pose far out would go the wrong way.
TEST(MapPicture, PosesThatNoPictureHoldsAreNotDrawn) {
  OccupancyMap map;
  map.geometry = {0.1, 0.0, 0.0, 40, 40};
  map.cells = CellStates(std::vector(map.geometry.cell_count(), CellState::kOccupied));
  PathOverlay overlay;
  for (const double x_m : {1.0, 2e5, 1e300, -1.7e308, 3.0}) overlay.trajectory.push_back({x_m, {x_m, 1.0, 0.0}});
  overlay.keyframes = overlay.doubtful = {1, 2, 3, 4};
  std::size_t points = 0;
  const auto expect_near = [&points](const Point2& at) {
    EXPECT_LE(at.lpNorm<Eigen::Infinity>(), 1e6);
    ++points;
  };
  const Canvas picture = map_picture(map, overlay, {}, {400, 400});
  for (const Shape& shape : picture.shapes()) {
    if (const auto* line = std::get_if<shape::Line>(&shape)) {
      std::for_each(line->points.begin(), line->points.end(), expect_near);
    }
    if (const auto* circle = std::get_if<shape::Circle>(&shape)) expect_near(circle->centre);
  }
  EXPECT_GE(points, 6U) << "both ends, the keyframe and the doubtful scan that can be seen";
}

TEST(PathLayer, SharesBeyondAnyNumberOfBandsHaveTheLastColours) {
  picture::MapFrame frame;
  frame.panel = {0.0, 0.0, 100.0, 100.0};
  frame.y_m = 100.0;
  for (const auto& [share, least, most] : {std::array{1e300, 0.98, 1.0}, std::array{-1e300, 0.0, 0.02},
                                           std::array{1e9, 0.98, 1.0}, std::array{0.5, 0.49, 0.52}}) {
    const Trajectory path{{0.0, {10.0, 50.0, 0.0}}, {1.0, {90.0, 50.0, 0.0}}};
    const std::vector<double> shares(2, share);
    std::vector<double> asked;
    Canvas canvas(100.0, 100.0, "");
    picture::draw_line_of_values(canvas, frame, {path, {}, shares},
                                 [&asked](double at) {
                                   asked.push_back(at);
                                   return ink::kText;
                                 },
                                 {ink::kCard, 2.4});
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_GE(asked[0], least) << share;
    EXPECT_LE(asked[0], most) << share;
  }
}

}  // namespace
}  // namespace gdtslam
