// The interval of a ratio of times. Expected: tables of the test of Mann and Whitney in textbooks, and a few lines of
// Python over all pairs.
#include "tools/lab/bench/ratio.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <vector>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

struct CriticalValue {
  std::size_t n;
  std::size_t m;
  std::size_t u;  ///< the largest that is significant at 5 %, on two sides
};

TEST(BenchRatio, CriticalValuesAreThoseOfTheTables) {
  constexpr std::array<CriticalValue, 8> kTable{
      {{4, 4, 0}, {5, 5, 2}, {6, 6, 5}, {8, 8, 13}, {7, 9, 12}, {10, 10, 23}, {15, 15, 64}, {20, 20, 127}}};
  for (const auto& [n, m, u] : kTable) {
    EXPECT_LE(mann_whitney_share(n, m, u), 0.025) << n << " and " << m;
    EXPECT_GT(mann_whitney_share(n, m, u + 1), 0.025) << n << " and " << m;
  }
}

TEST(BenchRatio, SharesOfSmallSamplesAreCounted) {
  EXPECT_DOUBLE_EQ(mann_whitney_share(3, 3, 0), 1.0 / 20.0);  // one of the 20 ways to choose 3 of 6
  EXPECT_DOUBLE_EQ(mann_whitney_share(2, 3, 1), 2.0 / 10.0);
  EXPECT_DOUBLE_EQ(mann_whitney_share(5, 5, 2), 4.0 / 252.0);
  EXPECT_DOUBLE_EQ(mann_whitney_share(4, 6, 24), 1.0);
}

// The 25 quotients in order; two are left out at each end.
TEST(BenchRatio, IntervalOfFiveSamplesEach) {
  const std::vector<double> before{2.0, 2.2, 2.1, 1.9, 9.0};
  const std::vector<double> now{1.0, 1.1, 0.9, 1.05, 1.2};
  const TimesRatio ratio = times_ratio(before, now);
  EXPECT_NEAR(ratio.middle, 2.0, 1e-12);
  EXPECT_NEAR(ratio.least, 1.9 / 1.1, 1e-12);
  EXPECT_NEAR(ratio.most, 9.0 / 1.05, 1e-12);
  EXPECT_NEAR(ratio.confidence, 1.0 - 8.0 / 252.0, 1e-12);
}

TEST(BenchRatio, OneSampleEachSaysNothingForSure) {
  const std::vector<double> before{3.0};
  const std::vector<double> now{2.0};
  const TimesRatio ratio = times_ratio(before, now);
  EXPECT_DOUBLE_EQ(ratio.middle, 1.5);
  EXPECT_DOUBLE_EQ(ratio.least, 1.5);
  EXPECT_DOUBLE_EQ(ratio.most, 1.5);
  EXPECT_DOUBLE_EQ(ratio.confidence, 0.0);
}

// Times with a long tail, the second half as long as the first: of many intervals 95 % hold the factor, both where
// ranks are counted and where the normal distribution stands for them.
TEST(BenchRatio, IntervalsHoldTheFactorAsOftenAsTheySay) {
  for (const std::size_t samples : {std::size_t{8}, std::size_t{40}}) {
    Random random(samples);
    const auto draw = [&random](double scale) {
      const double u = random.uniform(0.0, 1.0);
      return scale * (1.0 + 0.05 * u / (1.02 - u));
    };
    int held = 0;
    constexpr int kRatioTrials = 2000;
    for (int trial = 0; trial < kRatioTrials; ++trial) {
      std::vector<double> before(samples);
      std::vector<double> now(samples);
      for (double& time : before) time = draw(2.0);
      for (double& time : now) time = draw(1.0);
      const TimesRatio ratio = times_ratio(before, now);
      held += ratio.least <= 2.0 && 2.0 <= ratio.most ? 1 : 0;
    }
    EXPECT_GE(held, 0.935 * kRatioTrials) << samples;  // 3 standard deviations of the count below 95 %
    EXPECT_LE(held, 0.98 * kRatioTrials) << samples;
  }
}

}  // namespace
}  // namespace gdtslam
