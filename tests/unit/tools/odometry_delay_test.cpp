// Delays that were put in, of a robot that turns as a sum of waves does.
#include "engine/runs/streams/odometry_delay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

double heading_at(double t) { return 1.1 * std::sin(0.7 * t) + 0.6 * std::sin(1.9 * t + 0.4); }

/// 5 scans a second for 80 s. Odometry tells late what the robot did, with noise in each step, and slips now and then.
std::vector<TimedHeading> drive(double delay_s, double scan_noise_rad, double step_noise_rad, std::uint64_t seed) {
  Random random(seed);
  std::vector<TimedHeading> headings;
  double slip = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double t = 1000.0 + 0.2 * k;
    slip += step_noise_rad * random.normal() + (k % 57 == 56 ? 0.4 : 0.0);
    headings.push_back(
        {t, wrap_angle(heading_at(t - delay_s) + slip), heading_at(t) + scan_noise_rad * random.normal()});
  }
  return headings;
}

TEST(OdometryDelay, IsFoundEitherWayWithItsDeviation) {
  for (const double delay_s : {-0.65, -0.13, 0.07, 0.31, 0.65}) {
    int within = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto found = estimate_delay(drive(delay_s, 0.003, 0.004, seed));
      ASSERT_TRUE(found && found->stands_out()) << delay_s;
      EXPECT_NEAR(found->delay_s, delay_s, 0.015) << delay_s;
      within += std::fabs(found->delay_s - delay_s) <= 3.0 * found->sigma_s + 0.005 ? 1 : 0;
    }
    EXPECT_GE(within, 9) << delay_s;
  }
}

/// Turns whose speed wanders, for five minutes at 10 Hz, by a clock that ticks 200 times a second.
std::vector<TimedHeading> wandering_drive(double delay_s, double walk_rad, std::uint64_t seed) {
  constexpr double kTick_s = 0.005;
  constexpr int kTicks = 60'000;
  Random random(seed);
  std::vector<double> truth(kTicks);
  std::vector<double> wheels(kTicks);
  double speed = 0.0;
  double walk = 0.0;
  for (int i = 1; i < kTicks; ++i) {
    speed += -speed * kTick_s / 0.8 + 0.8 * std::sqrt(kTick_s) * random.normal();
    walk += walk_rad * std::sqrt(kTick_s) * random.normal();
    truth[static_cast<std::size_t>(i)] = truth[static_cast<std::size_t>(i - 1)] + kTick_s * speed;
    wheels[static_cast<std::size_t>(i)] = truth[static_cast<std::size_t>(i)] + walk;
  }
  const auto late = static_cast<int>(std::lround(delay_s / kTick_s));
  std::vector<TimedHeading> headings;
  for (int i = 400; i + 400 < kTicks; i += 20) {
    headings.push_back({1000.0 + kTick_s * i, wrap_angle(wheels[static_cast<std::size_t>(i - late)]),
                        truth[static_cast<std::size_t>(i)] + 0.001 * random.normal()});
  }
  return headings;
}

// Wheels that walk by three degrees a root of a second, 60 drives: linear interpolation between stamps alone was off by
// 16 ms (root of the mean square), towards half a period.
TEST(OdometryDelay, IsUnbiasedBesideNoisyWheels) {
  double sum_s = 0.0;
  double squares_s2 = 0.0;
  int within = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const double delay_s = -0.6 + 0.005 * static_cast<double>(4 * seed);
    const auto found = estimate_delay(wandering_drive(delay_s, 0.05, seed));
    ASSERT_TRUE(found);
    const double off_s = found->delay_s - delay_s;
    sum_s += off_s;
    squares_s2 += off_s * off_s;
    within += std::fabs(off_s) <= 3.0 * found->sigma_s ? 1 : 0;
  }
  EXPECT_LT(std::fabs(sum_s / 60.0), 0.002);
  EXPECT_LT(std::sqrt(squares_s2 / 60.0), 0.005);
  EXPECT_GE(within, 57) << "of 60";
}

/// Corridors at 5 Hz with a quarter turn every 20 s, and wheels as noisy from scan to scan as they slip elsewhere.
std::vector<TimedHeading> drive_past_corners(double delay_s, std::uint64_t seed) {
  const auto heading = [](double t) {
    const double corner = std::floor(t / 20.0);
    return 0.5 * kPi * (corner + std::clamp((t - 20.0 * corner) / 1.5, 0.0, 1.0));
  };
  Random random(seed);
  std::vector<TimedHeading> headings;
  double noise_rad = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double t = 100.0 + 0.2 * k;
    noise_rad += random.normal(0.0, 0.045);
    headings.push_back({t, wrap_angle(heading(t - delay_s) + noise_rad), wrap_angle(heading(t))});
  }
  return headings;
}

// Wheels of a slip of 3 cm a root metre on a track of half a metre: a delay is told by twenty corners, however much
// larger the noise of all other steps is together.
TEST(OdometryDelay, IsFoundBesideWheelsThatAreNoisierThanASlip) {
  for (const double delay_s : {-0.55, 0.3, 0.6}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto found = estimate_delay(drive_past_corners(delay_s, seed));
      ASSERT_TRUE(found && found->stands_out()) << delay_s << ' ' << seed;
      EXPECT_NEAR(found->delay_s, delay_s, 3.0 * found->sigma_s + 0.01) << seed;
    }
  }
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = estimate_delay(drive_past_corners(0.0, seed));
    EXPECT_FALSE(found && found->stands_out()) << seed << ' ' << found->delay_s;
  }
}

TEST(OdometryDelay, OfNoneNothingStandsOut) {
  // Steps that are as noisy as the turns themselves tempt to smooth them between two stamps.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double noise_rad : {0.002, 0.02, 0.1}) {
      const auto found = estimate_delay(drive(0.0, 0.003, noise_rad, seed));
      EXPECT_FALSE(found && found->stands_out()) << noise_rad << ' ' << seed << ' ' << found->delay_s;
    }
  }
}

TEST(OdometryDelay, ARobotThatHardlyTurnsTellsNothing) {
  std::vector<TimedHeading> headings;
  for (int k = 0; k < 400; ++k) headings.push_back({0.2 * k, 0.002 * k, 0.002 * k});
  EXPECT_FALSE(estimate_delay(headings));
  EXPECT_FALSE(estimate_delay({}));
}

ScanRecord scan_with_odometry(double stamp_s, double x_m) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.T_odom_base = Pose2{x_m, 0.0, 0.0};
  return record;
}

/// x = t, a scan in 0.1 s from 100 s on, given by what the log says of the clock; x of each scan that comes out.
std::vector<double> shifted(double delay_s, int scans, const std::function<double(int)>& clock) {
  OdometryShift shift(delay_s);
  std::vector<double> x_m;
  for (int k = 0; k < scans; ++k) {
    shift.take(scan_with_odometry(clock(k), 100.0 + 0.1 * k));
    while (auto scan = shift.next(false)) x_m.push_back(scan->T_odom_base->x_m);
  }
  while (auto scan = shift.next(true)) x_m.push_back(scan->T_odom_base->x_m);
  return x_m;
}

// Wherever the clock was set back, each scan gets the odometry of its side: delayed, but for those near the seam whose
// odometry lies beyond it.
TEST(OdometryShift, AClockThatIsSetBackBeginsAnotherStretch) {
  for (const double back_s : {1.0, 5.0, 20.0, 3600.0}) {
    for (const double delay_s : {0.3, -0.3}) {
      const std::vector<double> x_m =
          shifted(delay_s, 200, [&](int k) { return 100.0 + 0.1 * k - (k < 100 ? 0.0 : back_s); });
      ASSERT_EQ(x_m.size(), 200U);
      for (int k = 0; k < 200; ++k) {
        const double first_m = k < 100 ? 100.0 : 110.0;
        const double expected = std::clamp(100.0 + 0.1 * k + delay_s, first_m, first_m + 9.9);
        EXPECT_NEAR(x_m[static_cast<std::size_t>(k)], expected, 1e-6) << back_s << ' ' << delay_s << ' ' << k;
      }
    }
  }
}

// The odometry of a wild stamp is left out: the scan's own is what a step before or after it says, and the others do
// not notice.
TEST(OdometryShift, AStampThatIsWildIsLeftOut) {
  for (const double wild_s : {3600.0, 20.0, 2.0, -2.0, -5.0, -3600.0}) {
    for (const double delay_s : {0.3, -0.3}) {
      const std::vector<double> x_m =
          shifted(delay_s, 200, [&](int k) { return 100.0 + 0.1 * k + (k == 100 ? wild_s : 0.0); });
      ASSERT_EQ(x_m.size(), 200U);
      for (int k = 0; k < 200; ++k) {
        const double expected = std::clamp(100.0 + 0.1 * k + delay_s, 100.0, 119.9);
        EXPECT_NEAR(x_m[static_cast<std::size_t>(k)], expected, 1e-6) << wild_s << ' ' << delay_s << ' ' << k;
      }
    }
  }
}

TEST(OdometryDelay, IsFoundThoughTheClockWasSetBackOrOneStampIsWild) {
  for (const double back_s : {20.0, 3600.0}) {
    std::vector<TimedHeading> headings = drive(0.31, 0.003, 0.004, 3);
    for (std::size_t k = 200; k < headings.size(); ++k) headings[k].stamp_s -= back_s;
    const auto found = estimate_delay(headings);
    ASSERT_TRUE(found && found->stands_out()) << back_s;
    EXPECT_NEAR(found->delay_s, 0.31, 0.02) << back_s;
  }
  std::vector<TimedHeading> headings = drive(0.31, 0.003, 0.004, 3);
  headings[20].stamp_s += 3600.0;
  const auto found = estimate_delay(headings);
  ASSERT_TRUE(found && found->stands_out());
  EXPECT_NEAR(found->delay_s, 0.31, 0.02);
}

TEST(OdometryShift, ScansWithoutOdometryPass) {
  OdometryShift shift(0.3);
  ScanRecord bare;
  bare.scan.stamp_s = 1.0;
  shift.take(bare);
  const auto scan = shift.next(false);
  ASSERT_TRUE(scan);
  EXPECT_FALSE(scan->T_odom_base);
}

}  // namespace
}  // namespace gdtslam
