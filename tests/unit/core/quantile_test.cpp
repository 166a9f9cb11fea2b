// Against the definitions, worked by hand; the quarters of four values are those of numpy.percentile and of R (type 7).
#include "engine/core/quantile.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace gdtslam {
namespace {

TEST(Quantile, LiesBetweenTheTwoNearestValues) {
  const std::array four{1.0, 2.0, 3.0, 4.0};
  EXPECT_DOUBLE_EQ(quantile_of_sorted(four, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(four, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(std::array{7.0}, 0.95), 7.0);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(std::array{0.0, 10.0}, 1.0), 10.0);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(std::array{0.0, 10.0}, 0.0), 0.0);
  const std::array uneven{-3.5, 0.25, 0.5, 8.0, 9.0, 20.0};
  EXPECT_DOUBLE_EQ(quantile_of_sorted(uneven, 0.75), 8.75);
  EXPECT_DOUBLE_EQ(quantile_of_sorted(uneven, 0.95), 17.25);
}

TEST(ValueAtShare, IsTheLowerOfTheTwoNearestValues) {
  const std::vector<double> values{9.0, 0.25, 20.0, -3.5, 8.0, 0.5};
  const auto at = [&](double share) {
    std::vector<double> copy = values;
    return value_at_share(copy, share);
  };
  EXPECT_EQ(at(0.0), -3.5);
  EXPECT_EQ(at(0.5), 0.5);
  EXPECT_EQ(at(0.75), 8.0);
  EXPECT_EQ(at(0.95), 9.0);
  EXPECT_EQ(at(1.0), 20.0);
}

}  // namespace
}  // namespace gdtslam
