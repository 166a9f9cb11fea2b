// Summaries of many distances against sorting them.
#include "engine/runs/evaluation/distance_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

TEST(DistanceHistogram, AgreesWithTheSortedDistances) {
  Random random(5);
  DistanceHistogram histogram;
  std::vector<double> all;
  for (int i = 0; i < 9973; ++i) {
    all.push_back(std::fabs(random.normal()) * (i % 50 == 0 ? 5.0 : 0.02));
    histogram.add(all.back());
  }
  std::sort(all.begin(), all.end());
  const double mean = std::accumulate(all.begin(), all.end(), 0.0) / 9973.0;
  EXPECT_NEAR(histogram.mean_m(), mean, 1e-12);
  EXPECT_NEAR(histogram.rms_m(), std::sqrt(std::inner_product(all.begin(), all.end(), all.begin(), 0.0) / 9973.0),
              1e-12);
  EXPECT_EQ(histogram.max_m(), all.back());
  EXPECT_GT(all.back(), 10.0);  // so that the last bin is in use
  for (const double share : {0.001, 0.5, 0.9, 0.99}) {
    const double exact = all[static_cast<std::size_t>(std::ceil(share * 9973.0)) - 1];
    EXPECT_GE(histogram.quantile_m(share), exact) << share;
    EXPECT_LE(histogram.quantile_m(share), exact + 1.001e-5) << share;
  }
  EXPECT_EQ(histogram.quantile_m(1.0), all.back());
  for (std::size_t i = 0; i < DistanceHistogram::kLimits_m.size(); ++i) {
    const auto beyond =
        std::count_if(all.begin(), all.end(), [i](double d) { return d > DistanceHistogram::kLimits_m[i]; });
    EXPECT_EQ(histogram.share_beyond(i), static_cast<double>(beyond) / 9973.0);
  }
}

TEST(DistanceHistogram, RowsOfAMillimetre) {
  DistanceHistogram histogram;
  for (const double distance_m : {0.0, 0.0004, 0.0015, 0.0015, 0.9995, 1.5, 12.0}) histogram.add(distance_m);
  const std::string csv = histogram.csv();
  EXPECT_EQ(csv.substr(0, csv.find('\n', 30)), "from_m,to_m,points,share\n0.000,0.001,2,0.285714286");
  EXPECT_NE(csv.find("\n0.001,0.002,2,0.285714286\n"), std::string::npos);
  EXPECT_NE(csv.find("\n0.999,1.000,1,0.142857143\n1.000,inf,2,0.285714286\n"), std::string::npos);
}

TEST(DistanceHistogram, NothingIsNotZero) {
  EXPECT_TRUE(DistanceHistogram().json()["mean"].is_null());
  EXPECT_EQ(DistanceHistogram().json()["count"], 0);
  EXPECT_EQ(DistanceHistogram().quantile_m(0.5), 0.0);
}

}  // namespace
}  // namespace gdtslam
