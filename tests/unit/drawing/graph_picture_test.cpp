// The graph over a map as shapes, without pixels: loops, ellipses, what is not to be trusted, what the legend says.
#include "engine/drawing/maps/map_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

GraphOverlay graph_of_round_trip() {
  const PathOverlay path = round_trip();
  return {.trajectory = path.trajectory,
          .keyframes = path.keyframes,
          .loops = {{0, 50, 0.9, true}, {10, 60, 0.0, false}},
          .covariances = std::vector<PoseCovariance>(path.trajectory.size(), PoseCovariance{.xx = 0.04, .yy = 0.01}),
          .doubtful = {{20, 30}},
          .numbers = {{path.trajectory[25].T_map_base.translation(), 7}}};
}

TEST(GraphPicture, LegendCountsWhatThereIs) {
  const GraphOverlay overlay = graph_of_round_trip();
  const Canvas canvas = graph_picture(two_rooms(), overlay, {}, {1600, 1200});
  EXPECT_TRUE(says(canvas, "1 loop holds"));
  EXPECT_TRUE(says(canvas, "1 loop switched off"));
  EXPECT_TRUE(says(canvas, "10 keyframes"));
  EXPECT_TRUE(says(canvas, "3 sigma every"));
  EXPECT_TRUE(says(canvas, "not to be trusted"));
  EXPECT_TRUE(says(canvas, "7"));
  GraphOverlay path;
  path.trajectory = overlay.trajectory;
  const Canvas bare = graph_picture(two_rooms(), path, {}, {1600, 1200});
  for (const char* words : {"loop", "keyframe", "sigma", "trusted"}) EXPECT_FALSE(says(bare, words)) << words;
}

// Half as wide as three deviations of 0.2 m along x, times what the legend says: read off the shapes.
TEST(GraphPicture, EllipsesAreAsLargeAsTheLegendSays) {
  for (const double deviation_m : {0.2, 0.002}) {
    GraphOverlay overlay = graph_of_round_trip();
    for (PoseCovariance& covariance : overlay.covariances) {
      covariance = {.xx = deviation_m * deviation_m, .yy = 0.25 * deviation_m * deviation_m};
    }
    overlay.loops.clear();
    overlay.numbers.clear();
    // Two loops with ends in known places tell the scale.
    overlay.loops = {{0, 50, 1.0, true}};
    const Canvas canvas = graph_picture(two_rooms(), overlay, {}, {1600, 1200});
    const double apart_m =
        (overlay.trajectory[0].T_map_base.translation() - overlay.trajectory[50].T_map_base.translation()).norm();
    double px_per_m = 0.0;
    std::vector<double> half_widths;
    for (const shape::Line& line : shapes_of<shape::Line>(canvas)) {
      if (line.points.size() == 2 && px_per_m == 0.0) {
        const double length = (line.points[0] - line.points[1]).norm();
        if (std::fabs(line.pen.width - 2.6) < 1e-9) px_per_m = length / apart_m;
      }
    }
    for (const shape::Polygon& polygon : shapes_of<shape::Polygon>(canvas)) {
      if (polygon.points.size() < 20) continue;
      const auto [left, right] = std::minmax_element(polygon.points.begin(), polygon.points.end(),
                                                     [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
      half_widths.push_back(0.5 * (right->x() - left->x()));
    }
    ASSERT_GT(half_widths.size(), 3U);
    ASSERT_GT(px_per_m, 0.0);
    double factor = 1.0;
    for (const shape::Words& one : shapes_of<shape::Words>(canvas)) {
      const std::size_t at = one.text.find(", ");
      if (one.text.ends_with("times as large")) factor = std::atof(one.text.c_str() + at + 2);
    }
    EXPECT_NEAR(half_widths.front(), 3.0 * factor * deviation_m * px_per_m, 0.01 * half_widths.front()) << deviation_m;
  }
}

TEST(GraphPicture, WhatIsNotOfOneRunIsRefused) {
  const auto refused = [](const GraphOverlay& overlay) {
    EXPECT_THROW(graph_picture(two_rooms(), overlay, {}, {}), InputError);
  };
  GraphOverlay overlay = graph_of_round_trip();
  overlay.loops[0].to = overlay.trajectory.size();
  refused(overlay);
  overlay = graph_of_round_trip();
  overlay.covariances.pop_back();
  refused(overlay);
  overlay = graph_of_round_trip();
  overlay.doubtful[0].to = 1000;
  refused(overlay);
  overlay = graph_of_round_trip();
  overlay.keyframes.push_back(1000);
  refused(overlay);
}

}  // namespace
}  // namespace gdtslam
