// Matchers for poses, in the units people think in: EXPECT_THAT(T, PoseNear(expected, 0.001, 0.1)). A failure says how
// far the poses are apart in metres and degrees. The distances are computed without the functions under test.
#pragma once

#include <iosfwd>

#include <gmock/gmock.h>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// How GoogleTest prints a pose.
void PrintTo(const Pose2& pose, std::ostream* out);
void PrintTo(const Pose3& pose, std::ostream* out);

namespace test {

/// Within so many metres and degrees of the expected pose; a pose that is not finite is near nothing.
testing::Matcher<const Pose2&> PoseNear(const Pose2& expected, double metres, double degrees);
testing::Matcher<const Pose3&> PoseNear(const Pose3& expected, double metres, double degrees);

}  // namespace test
}  // namespace gdtslam
