// Laws of SE(2) at identity, near zero, at random and near half a turn. What exp and the products ought to be comes
// from homogeneous matrices and the exponential series in long double, which share nothing with the code under test.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "gdtslam/core/pose.hpp"
#include "generators.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::near_pose;
using test::PoseNear;

using Matrix3l = Eigen::Matrix<long double, 3, 3>;

Matrix3l matrix_of(const Pose2& T) {
  const auto theta = static_cast<long double>(T.theta_rad);
  Matrix3l matrix;
  matrix << std::cos(theta), -std::sin(theta), static_cast<long double>(T.x_m),  //
      std::sin(theta), std::cos(theta), static_cast<long double>(T.y_m),         //
      0.0L, 0.0L, 1.0L;
  return matrix;
}

Matrix3l hat(const Eigen::Vector3d& v) {
  const Eigen::Matrix<long double, 3, 1> w = v.cast<long double>();
  Matrix3l matrix;
  matrix << 0.0L, -w.z(), w.x(), w.z(), 0.0L, w.y(), 0.0L, 0.0L, 0.0L;
  return matrix;
}

// The largest difference of the two motions' matrices, relative to the size of the translations.
double distance(const Matrix3l& expected, const Pose2& found) {
  const long double scale = 1.0L + expected.col(2).head<2>().norm();
  return static_cast<double>((expected - matrix_of(found)).cwiseAbs().maxCoeff() / scale);
}

constexpr double kRounding = 1e-14;

RC_GTEST_PROP(Pose2Laws, ProductIsTheMatrixProduct, ()) {
  const Pose2 a = *test::pose2();
  const Pose2 b = *test::pose2();
  // The operands' size counts too: their difference may be small.
  const double scale = 1.0 + a.translation().norm() + b.translation().norm();
  RC_ASSERT(distance(matrix_of(a) * matrix_of(b), a * b) <= kRounding * scale);
}

RC_GTEST_PROP(Pose2Laws, InverseUndoes, ()) {
  const Pose2 T = *test::pose2();
  const double scale = 1.0 + T.translation().norm();
  RC_ASSERT(near_pose(T * inverse(T), {}, kRounding * scale, 1e-13));
  RC_ASSERT(near_pose(inverse(T) * T, {}, kRounding * scale, 1e-13));
  RC_ASSERT(near_pose(inverse(inverse(T)), T, kRounding * scale, 1e-13));
}

RC_GTEST_PROP(Pose2Laws, ActsOnPointsAsOnPoses, ()) {
  const Pose2 a = *test::pose2();
  const Pose2 b = *test::pose2();
  const Point2 p = (*test::pose2()).translation();
  const double scale = 1.0 + a.translation().norm() + b.translation().norm() + p.norm();
  RC_ASSERT(((a * b) * p - a * (b * p)).norm() <= kRounding * scale);
  const Pose2 at_p{p.x(), p.y(), 0.3};
  RC_ASSERT((a * at_p).translation() == a * p);
}

RC_GTEST_PROP(Pose2Laws, BetweenIsTheInverseTimesTheOther, ()) {
  const Pose2 a = *test::pose2();
  const Pose2 b = *test::pose2();
  const double scale = 1.0 + a.translation().norm() + b.translation().norm();
  RC_ASSERT(near_pose(between(a, b), inverse(a) * b, kRounding * scale, 1e-12));
  RC_ASSERT(near_pose(a * between(a, b), b, kRounding * scale, 1e-12));
}

RC_GTEST_PROP(Pose2Laws, ResultsStayInTheHalfOpenTurn, ()) {
  const Pose2 a = *test::pose2();
  Pose2 b = *test::pose2();
  b.theta_rad += 100.0;
  for (const double theta_rad : {(a * b).theta_rad, inverse(b).theta_rad, between(a, b).theta_rad,
                                 exp_se2({1.0, 2.0, b.theta_rad}).theta_rad, log_se2(b).z()}) {
    RC_ASSERT(theta_rad > -std::numbers::pi);
    RC_ASSERT(theta_rad <= std::numbers::pi);
  }
}

RC_GTEST_PROP(Pose2Laws, ExpIsTheMatrixExponential, ()) {
  const Eigen::Vector3d v = *test::tangent2();
  RC_ASSERT(distance(test::matrix_exponential(hat(v)), exp_se2(v)) <= kRounding);
}

RC_GTEST_PROP(Pose2Laws, LogUndoesExp, ()) {
  const Eigen::Vector3d v = *test::tangent2();
  RC_ASSERT((log_se2(exp_se2(v)) - v).cwiseAbs().maxCoeff() <= kRounding * (1.0 + v.norm()));
}

RC_GTEST_PROP(Pose2Laws, ExpUndoesLog, ()) {
  const Pose2 T = *test::pose2();
  RC_ASSERT(near_pose(exp_se2(log_se2(T)), T, kRounding * (1.0 + T.translation().norm()), 1e-12));
}

RC_GTEST_PROP(Pose2Laws, SmallMotionsKeepTheirRelativeAccuracy, ()) {
  // A series cut too early or 1 - cos would lose digits here, unseen by absolute bounds.
  const double theta_rad = std::fabs(*test::of_any_scale(0.1));
  const Pose2 T = exp_se2({1.0, 0.0, theta_rad});
  RC_ASSERT(std::fabs(T.y_m / (0.5 * theta_rad) - 1.0 + theta_rad * theta_rad / 12.0) <=
            2e-15 + std::pow(theta_rad, 4));
}

RC_GTEST_PROP(Pose2Laws, AdjointMovesAPerturbationFromTheRightToTheLeft, ()) {
  const Pose2 T = *test::pose2();
  const Eigen::Vector3d v = *test::tangent2();
  const double scale = (1.0 + T.translation().norm()) * (1.0 + v.norm());
  RC_ASSERT(near_pose(T * exp_se2(v), exp_se2(adjoint(T) * v) * T, 1e-13 * scale, 1e-12));
}

// Right perturbation: the tangent's translation is in the pose's own frame, forward first.
TEST(Pose2Convention, PerturbationsActOnTheRight) {
  const Pose2 T{10.0, 20.0, std::numbers::pi / 2.0};
  EXPECT_THAT(T * exp_se2({1.0, 0.0, 0.0}), PoseNear({10.0, 21.0, std::numbers::pi / 2.0}, 1e-12, 1e-12));
  EXPECT_THAT(T * exp_se2({0.0, 1.0, 0.0}), PoseNear({9.0, 20.0, std::numbers::pi / 2.0}, 1e-12, 1e-12));
  EXPECT_THAT(T * exp_se2({0.0, 0.0, 0.1}), PoseNear({10.0, 20.0, std::numbers::pi / 2.0 + 0.1}, 1e-12, 1e-12));
}

TEST(Pose2Convention, PlainCases) {
  EXPECT_EQ(exp_se2({0.0, 0.0, 0.0}), Pose2{});
  EXPECT_EQ(exp_se2({1.0, 2.0, 0.0}), (Pose2{1.0, 2.0, 0.0}));
  // Half a circle of radius 1: the chord is its diameter, to the left.
  const Pose2 half = exp_se2({std::numbers::pi, 0.0, std::numbers::pi});
  EXPECT_NEAR(half.x_m, 0.0, 1e-15);
  EXPECT_NEAR(half.y_m, 2.0, 1e-15);
  EXPECT_EQ(half.theta_rad, std::numbers::pi);
  EXPECT_TRUE((Pose2{1.0, 2.0, 3.0}).is_finite());
  EXPECT_FALSE((Pose2{1.0, std::nan(""), 3.0}).is_finite());
  EXPECT_FALSE((Pose2{1.0, 2.0, HUGE_VAL}).is_finite());
}

TEST(Pose2Convention, BetweenIsExactFarFromTheOrigin) {
  const Pose2 a{1e9, -1e9, 0.0};
  const Pose2 b{1e9 + 0.25, -1e9 + 0.5, 0.0};
  EXPECT_EQ(between(a, b), (Pose2{0.25, 0.5, 0.0}));
}

}  // namespace
}  // namespace gdtslam
