// What a comparison adds up to, against published intervals and hand-made trials.
#include "tools/lab/matchers/run.hpp"

#include <gtest/gtest.h>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/lab/matchers/methods.hpp"
#include "tools/lab/matchers/output.hpp"

namespace gdtslam {
namespace {

// Intervals of Newcombe's comparison of methods (1998), table I, method 3.
TEST(CompareFigures, SharesHaveTheIntervalsOfWilson) {
  const auto expect = [](std::uint64_t count, std::uint64_t of, double low, double high) {
    const Share share{count, of};
    EXPECT_NEAR(share.low(), low, 5e-5) << count << "/" << of;
    EXPECT_NEAR(share.high(), high, 5e-5) << count << "/" << of;
  };
  expect(81, 263, 0.2553, 0.3662);
  expect(15, 148, 0.0624, 0.1605);
  expect(0, 20, 0.0, 0.1611);
  expect(1, 29, 0.0061, 0.1718);
  EXPECT_EQ((Share{0, 0}.low()), 0.0);
  EXPECT_EQ((Share{0, 0}.high()), 1.0);
}

// Two walls of 2 x 41 points on either side, then an end of 9 points across: 9 normals along x, 82 along y. The walls
// lie symmetric around the robot, so turning says nothing of either; the parts are far from each other's neighbours.
TEST(CompareFigures, AScanHoldsByTheWallsAcross) {
  constexpr double kResolution_m = 0.05;
  std::vector<PointCells> points;
  for (int i = -20; i <= 20; ++i) points.push_back({static_cast<float>(i), -40.0F});
  for (int i = -20; i <= 20; ++i) points.push_back({static_cast<float>(i), 40.0F});
  EXPECT_NEAR(constraint_strength(line_information(points, kResolution_m)), 0.0, 1e-12);
  for (int i = -4; i <= 4; ++i) points.push_back({60.0F, static_cast<float>(i)});
  EXPECT_NEAR(constraint_strength(line_information(points, kResolution_m)), 9.0 / 82.0, 1e-12);
  // A turned robot sees the same; 3-4-5 keeps the numbers exact but for rounding.
  for (PointCells& point : points) {
    point = {0.6F * point.x - 0.8F * point.y, 0.8F * point.x + 0.6F * point.y};
  }
  EXPECT_NEAR(constraint_strength(line_information(points, kResolution_m)), 9.0 / 82.0, 1e-5);
  // Points by themselves have no line.
  const std::vector<PointCells> alone{{0.0F, 0.0F}, {100.0F, 0.0F}, {0.0F, 100.0F}};
  EXPECT_EQ(constraint_strength(line_information(alone, kResolution_m)), 0.0);
}

CompareTrial trial(std::uint32_t scan, std::uint32_t method, std::uint32_t level, double distance_m, double deg,
                   double seconds) {
  CompareTrial t;
  t.scan = scan;
  t.method = method;
  t.level = level;
  t.distance_m = t.x_m = distance_m;
  t.theta_rad = rad_from_deg(deg);
  t.seconds = seconds;
  t.evaluations = 10 * (method + 1);
  t.is_optimal = distance_m == 0.0;
  return t;
}

class Trials : public testing::Test {
 protected:
  void SetUp() override {
    job_.methods = {MatcherKind::kSimplex, MatcherKind::kPso};
    job_.levels = {{0.1, rad_from_deg(2.0)}};
    outcome_.scans.resize(4);
    for (CompareScan& scan : outcome_.scans) {
      scan.is_certified = true;
      scan.hold = 0.5;
    }
    outcome_.scans[2].hold = 0.001;
    outcome_.scans[3].is_certified = false;
    for (std::uint32_t scan = 0; scan < 4; ++scan) {
      for (std::uint32_t level = 0; level < 2; ++level) {
        outcome_.trials.push_back(trial(scan, 0, level, scan == 0 ? 0.0 : 0.03, 0.1, 1e-4));
        outcome_.trials.push_back(trial(scan, 1, level, 0.01, scan == 1 ? 0.6 : 0.1, 3e-4));
      }
    }
  }
  CompareJob job_;
  CompareOutcome outcome_;
};

TEST_F(Trials, CountByKindOfScan) {
  EXPECT_EQ(count_kind(outcome_, ScanKind::kHeld), 2U);
  EXPECT_EQ(count_kind(outcome_, ScanKind::kWeak), 1U);
  EXPECT_EQ(count_kind(outcome_, ScanKind::kUncertain), 1U);
  const auto figures = sum_figures(job_, outcome_, 0, ScanKind::kHeld);
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].distance_m.count, 2U);
  EXPECT_DOUBLE_EQ(figures[0].distance_m.max, 0.03);
  EXPECT_DOUBLE_EQ(figures[0].distance_m.mean, 0.015);
  EXPECT_EQ(figures[0].success.count, 1U);  // 0 m; 3 cm is too far
  EXPECT_EQ(figures[1].success.count, 1U);  // 0.6 degrees are too many
  EXPECT_EQ(figures[0].optimal.count, 1U);
  EXPECT_EQ(figures[1].optimal.count, 0U);
  EXPECT_DOUBLE_EQ(figures[1].evaluations.mean, 20.0);
  EXPECT_NEAR(figures[1].time_ratio, 3.0, 1e-12);
  EXPECT_EQ(sum_figures(job_, outcome_, 1, ScanKind::kWeak)[1].distance_m.count, 1U);
  EXPECT_EQ(collect_distances(outcome_, 0, 0, ScanKind::kHeld), (std::vector<double>{0.0, 0.03}));
}

}  // namespace
}  // namespace gdtslam
