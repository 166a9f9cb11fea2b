// The path over a map: what can be drawn of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

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

}  // namespace
}  // namespace gdtslam
