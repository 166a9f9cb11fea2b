#include "support/pose_matchers.hpp"

#include <limits>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gdtslam::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kDegree = std::numbers::pi / 180.0;

template <class Pose>
std::string explanation(const Pose& pose, const testing::Matcher<const Pose&>& matcher) {
  testing::StringMatchResultListener listener;
  matcher.MatchAndExplain(pose, &listener);
  return listener.str();
}

TEST(PoseNear, AcceptsUpToTheBoundsAndNoMore) {
  const Pose2 expected{1.0, 2.0, 0.5};
  EXPECT_THAT((Pose2{1.003, 2.004, 0.5}), PoseNear(expected, 0.0051, 0.1));
  EXPECT_THAT((Pose2{1.003, 2.004, 0.5}), Not(PoseNear(expected, 0.0049, 0.1)));
  EXPECT_THAT((Pose2{1.0, 2.0, 0.5 + 2.0 * kDegree}), PoseNear(expected, 0.001, 2.1));
  EXPECT_THAT((Pose2{1.0, 2.0, 0.5 + 2.0 * kDegree}), Not(PoseNear(expected, 0.001, 1.9)));
}

TEST(PoseNear, RefusesWhatIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT((Pose2{kNan, 0.0, 0.0}), Not(PoseNear(Pose2{}, 1e9, 360.0)));
  EXPECT_THAT((Pose2{0.0, 0.0, kNan}), Not(PoseNear(Pose2{}, 1e9, 360.0)));
}

TEST(PoseNear, KnowsSpace) {
  const Pose3 expected{{1.0, 2.0, 3.0}, Eigen::Quaterniond::Identity()};
  Pose3 other = expected;
  other.translation_m.z() += 0.25;
  other.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(3.0 * kDegree, Eigen::Vector3d::UnitY()));
  EXPECT_EQ(explanation(other, PoseNear(expected, 0.0, 0.0)), "which is 0.25 m and 3 deg away");
  EXPECT_THAT(other, PoseNear(expected, 0.2501, 3.001));
  EXPECT_THAT(other, Not(PoseNear(expected, 0.2499, 3.001)));
  EXPECT_THAT(other, Not(PoseNear(expected, 0.2501, 2.999)));
  other.rotation.coeffs() *= -1.0;
  EXPECT_THAT(other, PoseNear(expected, 0.2501, 3.001)) << "q and -q are one rotation";
  EXPECT_THAT(testing::PrintToString(expected), HasSubstr("(1 m, 2 m, 3 m, 0 deg"));
}

}  // namespace
}  // namespace gdtslam::test
