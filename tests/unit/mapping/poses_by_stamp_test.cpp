// The pose of a trajectory at a time.
#include "gdtslam/mapping/evaluation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace gdtslam {
namespace {

TEST(PosesByStamp, NearestWithinTheToleranceWhateverTheOrder) {
  const auto at = [](double stamp_s, double x_m) { return StampedPose{stamp_s, {x_m, 0.0, 0.0}}; };
  const PosesByStamp poses({at(3.0, 30.0), at(1.0, 10.0), at(2.0, 20.0), at(1.0, 11.0)});
  EXPECT_DOUBLE_EQ(poses.find(1.004, 0.01)->x_m, 11.0);  // the last of the log
  EXPECT_DOUBLE_EQ(poses.find(2.996, 0.01)->x_m, 30.0);
  EXPECT_DOUBLE_EQ(poses.find(2.4, 1.0)->x_m, 20.0);
  EXPECT_DOUBLE_EQ(poses.find(0.995, 0.01)->x_m, 11.0);
  EXPECT_FALSE(poses.find(2.5, 0.01).has_value());
  EXPECT_FALSE(poses.find(3.02, 0.01).has_value());
  EXPECT_EQ(poses.find_index(1.004, 0.01), 3U);
  EXPECT_EQ(poses.find_index(2.996, 0.01), 0U);
  EXPECT_FALSE(poses.find_index(2.5, 0.01).has_value());
  EXPECT_FALSE(PosesByStamp({}).find(1.0, 1.0).has_value());
  EXPECT_FALSE(poses.find(std::numeric_limits<double>::quiet_NaN(), 1.0).has_value());
}

TEST(PosesByStamp, LeavesOutPosesWithoutAStamp) {
  const PosesByStamp poses({{std::numeric_limits<double>::quiet_NaN(), {7.0, 0.0, 0.0}}, {1.0, {8.0, 0.0, 0.0}}});
  EXPECT_EQ(poses.find(1.0, 0.1)->x_m, 8.0);
  EXPECT_EQ(poses.find_index(1.0, 0.1), 1U);
}

}  // namespace
}  // namespace gdtslam
