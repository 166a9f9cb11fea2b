// Sweeps against each other: strokes are told apart, equal sweeps leave nothing, an error of the linkage is seen.
#include "engine/runs/drive/sweep_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::Rectangle;
using test::StandingScanner;

// A room with the scanner in it that nods up and down `strokes` times, posed with an elevation that is off by an error.
Cloud strokes(int count, double error_rad) {
  std::vector<Rectangle> scene = test::room({5.0, 4.0, 2.5});
  for (Rectangle& side : scene) side.corner -= Point3(2.0, 1.7, 0.3);
  for (const Rectangle& side : test::box_sides({1.6, 0.9, -0.3}, 0.5, {0.8, 0.6, 1.0})) scene.push_back(side);
  Random random(3);
  Cloud all;
  std::uint32_t scans = 0;
  for (int stroke = 0; stroke < count; ++stroke) {
    StandingScanner scanner;
    scanner.at = Point3::Zero();
    scanner.beams = 120;
    scanner.bearing_step_rad = 0.0333;
    scanner.scans = 90;
    scanner.elevation_step_rad = 0.012;
    const bool is_up = stroke % 2 == 0;
    if (!is_up) {
      scanner.first_elevation_rad = 90 * scanner.elevation_step_rad;
      scanner.elevation_step_rad = -scanner.elevation_step_rad;
    }
    // The elevation that the mount is believed to have is wrong on the way up by +error, on the way down by -error.
    const double believed_rad = is_up ? error_rad : -error_rad;
    Tangent3 wrong = Tangent3::Zero();
    wrong[4] = -believed_rad;  // about y: positive lifts
    const Cloud seen = test::moved(test::scan(scanner, scene, random), exp_se3(wrong));
    for (CloudPoint point : seen) {
      point.scan += scans;
      all.push_back(point);
    }
    scans += 90;
  }
  return all;
}

SweepCheck check_of(const Cloud& cloud, std::size_t piece) {
  SweepSampler sampler{SweepCheckConfig{}};
  for (std::size_t begin = 0; begin < cloud.size(); begin += piece) {
    sampler.add(std::span(cloud).subspan(begin, std::min(piece, cloud.size() - begin)));
  }
  return sampler.finish();
}

TEST(SweepCheck, StrokesOfAStandingScannerAgree) {
  const SweepCheck check = check_of(strokes(4, 0.0), 1'000);
  EXPECT_EQ(check.pairs, 3U);
  EXPECT_EQ(check.not_held, 0U);
  EXPECT_LT(check.mean_shift_m, 0.01);
  EXPECT_LT(check.mean_turn_rad, 0.003);
  EXPECT_GE(check.max_shift_m, check.mean_shift_m);
}

TEST(SweepCheck, AnErrorOfTheLinkageIsSeenAsTheTurnBetweenTheStrokes) {
  const double error_rad = 0.01;
  const SweepCheck check = check_of(strokes(4, error_rad), 1'000);
  EXPECT_EQ(check.pairs, 3U);
  EXPECT_NEAR(check.mean_turn_rad, 2.0 * error_rad, 0.004);
  // Up, down, up, down: the corrections cancel but for one.
  EXPECT_NEAR(check.drift_rad, 2.0 * error_rad, 0.005);
}

TEST(SweepCheck, AnErrorOfTheLinkageIsDoubtedAndNoiseIsNot) {
  EXPECT_EQ(check_of(strokes(4, 0.0), 1'000).doubt(), "");
  EXPECT_NE(check_of(strokes(4, 0.04), 1'000).doubt().find("times the noise of its surfaces"), std::string::npos);
}

/// How many sweeps were held against the one before, of scans of one point each at these elevations.
std::uint64_t compared(const std::vector<float>& elevations_rad) {
  SweepCheckConfig config;
  config.min_points = 1;
  SweepSampler sampler(config);
  std::uint32_t scan = 0;
  for (const float elevation_rad : elevations_rad) {
    CloudPoint point;
    point.elevation_rad = elevation_rad;
    point.scan = scan++;
    sampler.add({&point, 1});
  }
  const SweepCheck check = sampler.finish();
  return check.pairs + check.not_held;
}

// A sweep ends where the elevation is 0.05 rad behind its furthest, upwards as downwards.
TEST(SweepCheck, ASweepEndsWhereTheElevationHasTurnedBack) {
  for (const float sign : {-1.0F, 1.0F}) {
    EXPECT_EQ(compared({0.0F, sign * 0.1F, sign * 0.2F, sign * 0.151F}), 0U);
    EXPECT_EQ(compared({0.0F, sign * 0.1F, sign * 0.2F, sign * 0.149F}), 1U);
    EXPECT_EQ(compared({0.0F, sign * 0.1F, sign * 0.2F, sign * 0.16F, sign * 0.18F, sign * 0.149F}), 1U);
    EXPECT_EQ(compared({0.0F, sign * 0.1F, 0.0F, sign * 0.1F, 0.0F}), 3U);
    EXPECT_EQ(compared({sign * 0.3F, sign * 0.2F, sign * -0.3F}), 0U) << "wherever it begins, it goes one way";
    EXPECT_EQ(compared({sign * 0.3F, sign * 0.2F, sign * 0.26F}), 1U);
    EXPECT_EQ(compared({0.0F, sign * 0.1F, 0.0F, sign * 0.04F, sign * -0.1F}), 1U) << "not yet turned back again";
    EXPECT_EQ(compared({0.0F, sign * 0.04F, 0.0F, sign * -0.04F, 0.0F}), 0U) << "it has not begun to move";
  }
}

}  // namespace
}  // namespace gdtslam
