// Maps placed in the world by points: against motions that are known, and against a search that knows no formula.
#include "engine/runs/edits/edit_steps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

Point2 placed(double east, double north, double theta_rad, const Point2& p) {
  return {east + std::cos(theta_rad) * p.x() - std::sin(theta_rad) * p.y(),
          north + std::sin(theta_rad) * p.x() + std::cos(theta_rad) * p.y()};
}

double sum_of_squares(const std::vector<PointPair>& points, double east, double north, double theta_rad) {
  double sum = 0.0;
  for (const PointPair& p : points) sum += (placed(east, north, theta_rad, p.map_m) - p.world_m).squaredNorm();
  return sum;
}

TEST(Georeference, TwoPointsGiveTheirMotionBack) {
  for (const double degrees : {0.0, 37.5, 90.0, 180.0, -135.0}) {
    const double theta_rad = rad_from_deg(degrees);
    std::vector<PointPair> points;
    for (const Point2& p : {Point2(0.5, 1.0), Point2(30.0, -12.0)}) {
      points.push_back({p, placed(455012.25, 5411930.5, theta_rad, p)});
    }
    const Georeference fit = fit_georeference(points);
    EXPECT_NEAR(fit.T_world_map.x_m, 455012.25, 1e-7);
    EXPECT_NEAR(fit.T_world_map.y_m, 5411930.5, 1e-7);
    EXPECT_NEAR(std::remainder(fit.T_world_map.theta_rad - theta_rad, kTwoPi), 0.0, 1e-9);
    EXPECT_LT(fit.rms_m, 1e-8);
    EXPECT_NEAR(fit.scale, 1.0, 1e-9);
  }
}

// Nothing near the fit is better, in any direction: what least squares are.
TEST(Georeference, NoMotionNearbyIsBetter) {
  Random random(7);
  std::vector<PointPair> points;
  for (int k = 0; k < 8; ++k) {
    const Point2 p{random.uniform(-40.0, 40.0), random.uniform(-40.0, 40.0)};
    const Point2 noise{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    points.push_back({p, placed(1000.0, 2000.0, 0.7, p) + noise});
  }
  const Georeference fit = fit_georeference(points);
  const Pose2& T = fit.T_world_map;
  const double least = sum_of_squares(points, T.x_m, T.y_m, T.theta_rad);
  EXPECT_NEAR(fit.rms_m, std::sqrt(least / 8.0), 1e-9);
  for (const double step : {1e-4, -1e-4}) {
    EXPECT_GT(sum_of_squares(points, T.x_m + step, T.y_m, T.theta_rad), least);
    EXPECT_GT(sum_of_squares(points, T.x_m, T.y_m + step, T.theta_rad), least);
    EXPECT_GT(sum_of_squares(points, T.x_m, T.y_m, T.theta_rad + step), least);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double off_m = (placed(T.x_m, T.y_m, T.theta_rad, points[k].map_m) - points[k].world_m).norm();
    EXPECT_NEAR(fit.residuals_m[k], off_m, 1e-8);
  }
}

TEST(WorldFile, PutsPixelsWhereTheirCellsAre) {
  const GridGeometry map{.resolution_m = 0.05, .origin_x_m = -3.2, .origin_y_m = 1.5, .width = 40, .height = 30};
  const double theta_rad = rad_from_deg(25.0);
  std::istringstream text(world_file_text(map, {300000.0, 5000000.0, theta_rad}));
  double a = 0.0, d = 0.0, b = 0.0, e = 0.0, c = 0.0, f = 0.0;
  ASSERT_TRUE(text >> a >> d >> b >> e >> c >> f);
  for (const auto& [column, row] : {std::pair{0, 0}, {39, 0}, {0, 29}, {21, 13}}) {
    const Point2 centre = map.cell_centre({column, map.height - 1 - row});
    const Point2 world = placed(300000.0, 5000000.0, theta_rad, centre);
    EXPECT_NEAR(a * column + b * row + c, world.x(), 1e-8);
    EXPECT_NEAR(d * column + e * row + f, world.y(), 1e-8);
  }
}

TEST(WorldFile, WithoutTurnHasSquarePixels) {
  const GridGeometry map{.resolution_m = 0.5, .origin_x_m = 10.0, .origin_y_m = 20.0, .width = 4, .height = 2};
  EXPECT_EQ(world_file_text(map, {}), "0.5\n0\n0\n-0.5\n10.25\n20.75\n");
}

}  // namespace
}  // namespace gdtslam
