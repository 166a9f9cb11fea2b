// The laser against theory: beams, noise, drop-outs, limits, the motion within a scan.
#include "gdtslam/sim/laser_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

LaserModel plain_laser() {
  LaserModel laser = *laser_preset("sick-lms");
  laser.noise_constant_m = 0.0;
  laser.drop_out_share = 0.0;
  laser.range_resolution_m = 0.0;
  laser.mirror_rate_hz = 0.0;
  return laser;
}

RayCaster measured_room() {
  Scene scene;
  scene.boxes.push_back({{0.0, 0.0}, {8.0, 6.0}, 0.0, 0.0, 2.5});
  return RayCaster(triangulate(scene));
}

std::vector<double> true_ranges(const LaserModel& laser, const RayCaster& caster, const LaserPoseAt& T_map_laser_at) {
  std::vector<double> ranges_m;
  for (const BeamTruth& beam : true_beams(laser, caster, T_map_laser_at)) ranges_m.push_back(beam.range_m);
  return ranges_m;
}

TEST(LaserModel, PresetsSpanWhatTheirSensorsSpan) {
  const LaserModel lms = *laser_preset("sick-lms");
  EXPECT_EQ(lms.beam_count, 180U);
  EXPECT_NEAR(deg_from_rad(lms.first_bearing_rad + 179 * lms.bearing_step_rad), 89.0, 1e-9);
  const LaserModel fine = *laser_preset("sick-361");
  EXPECT_EQ(fine.beam_count, 361U);
  EXPECT_NEAR(deg_from_rad(fine.first_bearing_rad + 360 * fine.bearing_step_rad), 90.0, 1e-9);
  // The paper: -30 to 210 deg with 90 deg ahead, 961 beams.
  const LaserModel hokuyo = *laser_preset("hokuyo-961");
  EXPECT_EQ(hokuyo.beam_count, 961U);
  EXPECT_NEAR(deg_from_rad(hokuyo.first_bearing_rad) + 90.0, -30.0, 1e-9);
  EXPECT_NEAR(deg_from_rad(hokuyo.first_bearing_rad + 960 * hokuyo.bearing_step_rad) + 90.0, 210.0, 1e-9);
  EXPECT_EQ(hokuyo.max_range_m, 20.0);
  for (const std::string& name : laser_preset_names()) {
    EXPECT_TRUE(validate(*laser_preset(name)).empty()) << name;
  }
  EXPECT_FALSE(laser_preset("sick"));
}

TEST(LaserModel, TrueRangesAreThoseOfTheRoom) {
  const Pose3 T_map_laser = embed(Pose2{1.0, -0.5, rad_from_deg(20.0)}, 1.0);
  const std::vector<double> ranges_m = true_ranges(plain_laser(), measured_room(), [&](double) { return T_map_laser; });
  ASSERT_EQ(ranges_m.size(), 180U);
  for (std::size_t k = 0; k < ranges_m.size(); ++k) {
    const double bearing = rad_from_deg(20.0 - 90.0 + static_cast<double>(k));
    const double to_x = (std::cos(bearing) > 0.0 ? 3.0 : 5.0) / std::fabs(std::cos(bearing));
    const double to_y = (std::sin(bearing) > 0.0 ? 3.5 : 2.5) / std::fabs(std::sin(bearing));
    ASSERT_NEAR(ranges_m[k], std::min(to_x, to_y), 1e-12) << k;
  }
}

struct Statistics {
  double mean = 0.0;
  double deviation = 0.0;
  double dropped = 0.0;
};

Statistics statistics_of(const LaserModel& laser, double range_m, int count) {
  Random random(17);
  double sum = 0.0;
  double sum_sq = 0.0;
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const double measured_m = measured_range(laser, range_m, random);
    if (measured_m != laser.no_return_m) {
      ++kept;
      sum += measured_m - range_m;
      sum_sq += (measured_m - range_m) * (measured_m - range_m);
    }
  }
  const double mean = sum / kept;
  return {mean, std::sqrt(sum_sq / kept - mean * mean), 1.0 - static_cast<double>(kept) / count};
}

TEST(LaserModel, NoiseAndDropOutsHaveTheirSizes) {
  LaserModel laser = plain_laser();
  laser.noise_constant_m = 0.02;
  laser.noise_share = 0.005;
  laser.drop_out_share = 0.03;
  constexpr int kCount = 200'000;
  for (const double range_m : {1.0, 12.0}) {
    const double sigma = 0.02 + 0.005 * range_m;
    const Statistics statistics = statistics_of(laser, range_m, kCount);
    // Five standard errors of each estimate.
    EXPECT_NEAR(statistics.mean, 0.0, 5.0 * sigma / std::sqrt(kCount));
    EXPECT_NEAR(statistics.deviation, sigma, 5.0 * sigma / std::sqrt(2.0 * kCount));
    EXPECT_NEAR(statistics.dropped, 0.03, 5.0 * std::sqrt(0.03 * 0.97 / kCount));
  }
}

TEST(LaserModel, RoundingAddsItsVarianceAndGivesMultiples) {
  LaserModel laser = plain_laser();
  laser.noise_constant_m = 0.03;
  laser.range_resolution_m = 0.05;
  const Statistics statistics = statistics_of(laser, 7.013, 200'000);
  EXPECT_NEAR(statistics.mean, 0.0, 5e-4);
  EXPECT_NEAR(statistics.deviation, std::sqrt(0.03 * 0.03 + 0.05 * 0.05 / 12.0), 3e-4);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double steps = measured_range(laser, 3.3, random) / 0.05;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
}

TEST(LaserModel, LimitsGiveNoReturn) {
  LaserModel laser = plain_laser();
  laser.min_range_m = 0.1;
  laser.max_range_m = 10.0;
  Random random(1);
  EXPECT_EQ(measured_range(laser, 0.05, random), 81.91);
  EXPECT_EQ(measured_range(laser, 0.1, random), 0.1);
  EXPECT_EQ(measured_range(laser, 9.999, random), 9.999);
  EXPECT_EQ(measured_range(laser, 10.0, random), 81.91);
  EXPECT_EQ(measured_range(laser, std::numeric_limits<double>::infinity(), random), 81.91);
  laser.noise_constant_m = 0.5;
  for (int i = 0; i < 1000; ++i) {
    const double measured_m = measured_range(laser, 9.9, random);
    EXPECT_TRUE(measured_m < 10.0 || measured_m == 81.91);
  }
}

TEST(LaserModel, ScanIsSpreadOverTheMirrorsTurn) {
  LaserModel laser = plain_laser();
  laser.mirror_rate_hz = 75.0;
  // 179 of 360 steps of a turn of 1/75 s, with the stamp in their middle.
  EXPECT_NEAR(laser.time_of_beam_s(179) - laser.time_of_beam_s(0), 179.0 / 360.0 / 75.0, 1e-15);
  EXPECT_NEAR(laser.time_of_beam_s(0) + laser.time_of_beam_s(179), 0.0, 1e-15);
  // Drives at 3 m/s at the wall ahead, 4 m away at the stamp.
  const std::vector<double> ranges_m = true_ranges(laser, measured_room(), [](double offset_s) {
    return embed(Pose2{3.0 * offset_s, 0.0, 0.0}, 1.0);
  });
  for (const std::size_t k : {70U, 90U, 110U}) {
    const double bearing = rad_from_deg(static_cast<double>(k) - 90.0);
    EXPECT_NEAR(ranges_m[k], (4.0 - 3.0 * laser.time_of_beam_s(k)) / std::cos(bearing), 1e-12);
  }
}

}  // namespace
}  // namespace gdtslam::sim
