// Single surface points on single lines, by hand; many of them against a search that asks all; and which keyframes a
// scan is laid on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "engine/mapping/adjust/point_to_line.hpp"
#include "engine/mapping/adjust/scan_adjustment.hpp"
#include "gdtslam/core/random.hpp"
#include "support/adjusted_scan.hpp"

namespace gdtslam {
namespace {

SurfacePoint surface_point(double x_m, double y_m, double turn_rad = 0.0) {
  return {static_cast<float>(x_m), static_cast<float>(y_m), -static_cast<float>(std::cos(turn_rad)),
          -static_cast<float>(std::sin(turn_rad)), static_cast<float>(pseudo_bearing(x_m, y_m))};
}

KeptScan scan_with(std::vector<SurfacePoint> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.direction < b.direction; });
  return {std::move(points), {}};
}

constexpr LineGate kGate{.most_m = 0.2, .points = 100};

/// With walls far away, so that the scan sees half a circle.
KeptScan half_circle_with(std::vector<SurfacePoint> points) {
  points.push_back(surface_point(0.0, -50.0));
  points.push_back(surface_point(0.0, 50.0));
  return scan_with(std::move(points));
}

LineEquations point_on_line(const SurfacePoint& point, const SurfacePoint& line) {
  return line_equations(LineScan(scan_with({line})), LineScan(scan_with({point})), {}, kGate);
}

// Geman and McClure's kernel is 0.3 of the gate wide: at 6 cm a point counts for a quarter.
TEST(PointToLine, WeighsAPointByItsDistanceFromTheLine) {
  const LineEquations lines = point_on_line(surface_point(2.06, 0.1), surface_point(2.0, 0.0));
  EXPECT_NEAR(lines.weight, 0.25, 1e-5);
  EXPECT_NEAR(lines.cost_m2, 0.25 * 0.0036, 1e-7);
  // The point is 6 cm behind the line, whose normal is -x; J = (-1, 0, 0.1).
  EXPECT_NEAR(lines.gradient[0], 0.25 * 0.06, 1e-6);
  EXPECT_NEAR(lines.gradient[1], 0.0, 1e-6);
  EXPECT_NEAR(lines.gradient[2], -0.25 * 0.06 * 0.1, 1e-6);
  EXPECT_NEAR(lines.information(0, 0), 0.25, 1e-5);
  EXPECT_NEAR(lines.information(0, 2), -0.025, 1e-6);
  EXPECT_NEAR(lines.information(2, 2), 0.0025, 1e-6);
  EXPECT_NEAR(lines.information(1, 1), 0.0, 1e-6);
}

TEST(PointToLine, APointCountsWithinTheGateToEitherSide) {
  for (const double side : {-1.0, 1.0}) {
    EXPECT_NEAR(point_on_line(surface_point(2.0, side * 0.195), surface_point(2.0, 0.0)).weight, 1.0, 1e-5);
    EXPECT_EQ(point_on_line(surface_point(2.0, side * 0.205), surface_point(2.0, 0.0)).weight, 0.0);
    EXPECT_GT(point_on_line(surface_point(2.0 + side * 0.19, 0.0), surface_point(2.0, 0.0)).weight, 0.0);
    EXPECT_EQ(point_on_line(surface_point(2.0 + side * 0.21, 0.0), surface_point(2.0, 0.0)).weight, 0.0);
  }
}

// In the moving scan's own frame: the same wall, seen from a robot that is turned by a quarter.
TEST(PointToLine, EquationsAreThoseOfTheMovingScan) {
  const Pose2 T_fixed_moving{0.0, 0.0, 0.5 * 3.14159265358979};
  const SurfacePoint aside{0.1F, -2.06F, 0.0F, 1.0F, static_cast<float>(pseudo_bearing(0.1, -2.06))};
  const LineEquations lines = line_equations(LineScan(scan_with({surface_point(2.0, 0.0)})),
                                             LineScan(scan_with({aside})), T_fixed_moving, kGate);
  EXPECT_NEAR(lines.weight, 0.25, 1e-4);
  // n = (0, 1) in its frame, 6 cm too far.
  EXPECT_NEAR(lines.gradient[0], 0.0, 1e-6);
  EXPECT_NEAR(lines.gradient[1], -0.25 * 0.06, 1e-5);
  EXPECT_NEAR(lines.gradient[2], -0.25 * 0.06 * 0.1, 1e-5);
}

/// Somewhere ahead; x is drawn first.
SurfacePoint drawn_point(Random& random) {
  const double x_m = random.uniform(1.0, 3.0);
  const double y_m = random.uniform(-2.0, 2.0);
  return surface_point(x_m, y_m);
}

/// The weight of a point on the nearest of all that lie within the gate and so near to its direction as the gate
/// allows.
double weight_by_asking_all(const std::vector<SurfacePoint>& lines, const SurfacePoint& p) {
  const double direction = pseudo_bearing(static_cast<double>(p.x_m), static_cast<double>(p.y_m));
  const double reach = kGate.most_m / p.point().norm();
  double least_m = kGate.most_m;
  double weight = 0.0;
  for (const SurfacePoint& line : lines) {
    const double away_m = (line.point() - p.point()).norm();
    if (away_m >= least_m || std::fabs(static_cast<double>(line.direction) - direction) > reach) continue;
    const double off_m = static_cast<double>(line.x_m) - static_cast<double>(p.x_m);
    const double share = 1.0 / (1.0 + off_m * off_m / 0.0036);
    least_m = away_m;
    weight = share * share;
  }
  return weight;
}

// In any order: the search goes on from where the last one ended.
TEST(PointToLine, FindsTheNearestOfAll) {
  Random random(5);
  for (int round = 0; round < 50; ++round) {
    std::vector<SurfacePoint> lines;
    for (int k = 0; k < 12; ++k) lines.push_back(drawn_point(random));
    const LineScan fixed(half_circle_with(lines));
    KeptScan moving;
    double expected = 0.0;
    for (int k = 0; k < 40; ++k) {
      moving.surface.push_back(drawn_point(random));
      expected += weight_by_asking_all(lines, moving.surface.back());
    }
    EXPECT_NEAR(line_equations(fixed, LineScan(moving), {}, kGate).weight, expected, 1e-6) << round;
  }
}

// The fixed scan sees directions from -45 to 45 degrees, and half a beam more.
TEST(PointToLine, BeyondTheFieldOfViewAPointIsOnNoLine) {
  std::vector<SurfacePoint> wall;
  for (int k = -20; k <= 20; ++k) wall.push_back(surface_point(2.0, 0.1 * k));
  const auto weight_at = [&](double y_m) {
    return line_equations(LineScan(scan_with(wall)), LineScan(scan_with({surface_point(2.0, y_m)})), {}, kGate).weight;
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_NEAR(weight_at(side * 2.02), 1.0, 1e-6);
    EXPECT_EQ(weight_at(side * 2.08), 0.0);
  }
}

/// Walls 1.2 m to either side of a robot that drives along them, by a beam a degree ahead and aside.
KeptScan corridor_scan(Random& random) {
  std::vector<Point2> points;
  for (int degrees = -90; degrees <= 90; ++degrees) {
    const double angle_rad = degrees * 3.14159265358979 / 180.0;
    if (std::abs(degrees) < 10) continue;  // nothing in reach
    const double range_m = 1.2 / std::fabs(std::sin(angle_rad)) + 0.01 * random.normal();
    points.emplace_back(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
  }
  return keep_scan(points);
}

// Nothing stands across the way, so scans half a metre apart may tell nothing along it on average, whichever is laid on
// the other. With points beyond the field of view on the line of its last beam the mean was 0.0046 m; a sixth of it is
// left.
TEST(PointToLine, AlongACorridorScansDoNotPullEachOther) {
  Random random(11);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kPairs = 400;
  for (int pair = 0; pair < kPairs; ++pair) {
    const LineScan earlier(corridor_scan(random));
    const LineScan later(corridor_scan(random));
    const LineGate gate{.most_m = 0.1, .points = 1000};
    const double pull = line_equations(earlier, later, {0.5, 0.0, 0.0}, gate).gradient[0] -
                        line_equations(later, earlier, {-0.5, 0.0, 0.0}, gate).gradient[0];
    sum += pull;
    squares += pull * pull;
  }
  const double mean = sum / kPairs;
  const double sigma_of_mean = std::sqrt((squares / kPairs - mean * mean) / kPairs);
  EXPECT_LT(std::fabs(mean) + 3.0 * sigma_of_mean, 0.0015) << "mean " << mean << " sigma " << sigma_of_mean;
}

/// A wall so far ahead of keyframes at these poses: each says that the scan, which has it 2 m ahead, is off by the
/// rest.
class ScanOnKeyframes {
 public:
  explicit ScanOnKeyframes(ScanAdjustmentOptions options = {}) : options_(options) {}
  void add(const Pose2& pose, double ahead_m) {
    poses_.push_back(pose);
    std::vector<SurfacePoint> wall;
    for (int k = -5; k <= 5; ++k) wall.push_back(surface_point(ahead_m - pose.x_m, 0.05 * k - pose.y_m));
    keyframes_.emplace_back(half_circle_with(wall));
  }
  [[nodiscard]] double moved_to(std::optional<std::size_t> last) const {
    std::vector<SurfacePoint> wall;
    for (int k = -5; k <= 5; ++k) wall.push_back(surface_point(2.0, 0.05 * k));
    const ScanAdjustment adjustment(keyframes_, poses_, options_);
    return test::adjusted(adjustment, keyframes_, LineScan(scan_with(wall)), {}, last).x_m;
  }

 private:
  ScanAdjustmentOptions options_;
  std::vector<LineScan> keyframes_;
  std::vector<Pose2> poses_;
};

// 11 points weigh w each by the kernel; what holds the pose is 0.3 of a tenth of the trace, and 0.3.
TEST(ScanOnKeyframe, IsPulledToItAgainstItsStiffness) {
  ScanOnKeyframes scene({.iterations = 1});
  scene.add({}, 2.03);
  const double scale_m = 0.3 * 0.15;
  const double share = 1.0 / (1.0 + 0.03 * 0.03 / (scale_m * scale_m));
  const double w = share * share;
  double lever = 0.0;
  for (int k = -5; k <= 5; ++k) lever += w * 0.05 * 0.05 * k * k;
  const double hold = 0.3 * (0.1 * (11.0 * w + lever) + 1.0);
  EXPECT_NEAR(scene.moved_to(0), 0.03 * 11.0 * w / (11.0 * w + hold), 1e-5);
}

}  // namespace
}  // namespace gdtslam
