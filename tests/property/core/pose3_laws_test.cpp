// Laws of SE(3) at identity, near zero, at random and near half a turn. What exp and the products ought to be comes
// from homogeneous matrices, Eigen and the exponential series in long double.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "gdtslam/core/pose3.hpp"
#include "generators.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::near_pose;
using test::PoseNear;

using Matrix4l = Eigen::Matrix<long double, 4, 4>;

Matrix4l matrix_of(const Pose3& T) {
  Matrix4l matrix = Matrix4l::Identity();
  matrix.topLeftCorner<3, 3>() = T.rotation.cast<long double>().toRotationMatrix();
  matrix.topRightCorner<3, 1>() = T.translation_m.cast<long double>();
  return matrix;
}

Matrix4l hat(const Tangent3& v) {
  const Eigen::Matrix<long double, 6, 1> w = v.cast<long double>();
  Matrix4l matrix;
  matrix << 0.0L, -w[5], w[4], w[0],  //
      w[5], 0.0L, -w[3], w[1],        //
      -w[4], w[3], 0.0L, w[2],        //
      0.0L, 0.0L, 0.0L, 0.0L;
  return matrix;
}

double size(const Pose3& T) { return 1.0 + T.translation_m.norm(); }

double distance(const Matrix4l& expected, const Pose3& found) {
  return static_cast<double>((expected - matrix_of(found)).cwiseAbs().maxCoeff());
}

constexpr double kRounding3 = 1e-14;

RC_GTEST_PROP(Pose3Laws, ProductIsTheMatrixProduct, ()) {
  const Pose3 a = *test::pose3();
  const Pose3 b = *test::pose3();
  RC_ASSERT(distance(matrix_of(a) * matrix_of(b), a * b) <= kRounding3 * (size(a) + size(b)));
}

RC_GTEST_PROP(Pose3Laws, RotationsStayUnitAlongAChain, ()) {
  const Pose3 a = *test::pose3();
  Pose3 T = *test::pose3();
  for (int i = 0; i < 1000; ++i) {
    T = T * a;
  }
  RC_ASSERT(std::fabs(T.rotation.norm() - 1.0) <= 1e-15);
}

RC_GTEST_PROP(Pose3Laws, InverseUndoes, ()) {
  const Pose3 T = *test::pose3();
  RC_ASSERT(near_pose(T * inverse(T), {}, kRounding3 * size(T), 1e-14));
  RC_ASSERT(near_pose(inverse(T) * T, {}, kRounding3 * size(T), 1e-14));
  RC_ASSERT(near_pose(inverse(inverse(T)), T, kRounding3 * size(T), 1e-14));
}

RC_GTEST_PROP(Pose3Laws, ActsOnPointsAsOnPoses, ()) {
  const Pose3 a = *test::pose3();
  const Pose3 b = *test::pose3();
  const Point3 p = *test::point3();
  RC_ASSERT(((a * b) * p - a * (b * p)).norm() <= kRounding3 * (size(a) + size(b) + p.norm()));
  RC_ASSERT((a * Pose3{p, b.rotation}).translation_m == a * p);
}

RC_GTEST_PROP(Pose3Laws, BetweenIsTheInverseTimesTheOther, ()) {
  const Pose3 a = *test::pose3();
  const Pose3 b = *test::pose3();
  RC_ASSERT(near_pose(between(a, b), inverse(a) * b, kRounding3 * (size(a) + size(b)), 1e-14));
  RC_ASSERT(near_pose(a * between(a, b), b, kRounding3 * (size(a) + size(b)), 1e-14));
}

RC_GTEST_PROP(Pose3Laws, ExpIsTheMatrixExponential, ()) {
  const Tangent3 v = *test::tangent3();
  RC_ASSERT(distance(test::matrix_exponential(hat(v)), exp_se3(v)) <= kRounding3 * (1.0 + v.norm()));
}

RC_GTEST_PROP(Pose3Laws, LogUndoesExp, ()) {
  const Tangent3 v = *test::tangent3();
  // Near half a turn the cotangent loses digits as 1 / (pi - angle) does not: its factor tends to 0 there.
  RC_ASSERT((log_se3(exp_se3(v)) - v).cwiseAbs().maxCoeff() <= 1e-13 * (1.0 + v.norm()));
}

RC_GTEST_PROP(Pose3Laws, ExpUndoesLog, ()) {
  const Pose3 T = *test::pose3();
  RC_ASSERT(near_pose(exp_se3(log_se3(T)), T, 1e-13 * size(T), 1e-14));
}

RC_GTEST_PROP(Pose3Laws, LogIsTheShortWayRound, ()) {
  Pose3 T = *test::pose3();
  const Eigen::Vector3d turn = log_so3(T.rotation);
  RC_ASSERT(turn.norm() <= std::numbers::pi + 1e-15);
  T.rotation.coeffs() *= -1.0;
  RC_ASSERT((log_so3(T.rotation) - turn).norm() <= 1e-15);
}

RC_GTEST_PROP(Pose3Laws, AdjointMovesAPerturbationFromTheRightToTheLeft, ()) {
  const Pose3 T = *test::pose3();
  const Tangent3 v = *test::tangent3();
  const double scale = size(T) * (1.0 + v.norm());
  RC_ASSERT(near_pose(T * exp_se3(v), exp_se3(adjoint(T) * v) * T, 1e-13 * scale, 1e-13));
}

RC_GTEST_PROP(Pose3Laws, RotationMatrixIsEigens, ()) {
  const Pose3 T = *test::pose3();
  RC_ASSERT((rotation_matrix(T.rotation) - T.rotation.toRotationMatrix()).cwiseAbs().maxCoeff() <= 1e-15);
}

RC_GTEST_PROP(Pose3Laws, EmbeddingKeepsProducts, ()) {
  const Pose2 a = *test::pose2();
  const Pose2 b = *test::pose2();
  const double scale = 1.0 + a.translation().norm() + b.translation().norm();
  RC_ASSERT(near_pose(embed(a, 0.5) * embed(b, 0.25), embed(a * b, 0.75), kRounding3 * scale, 1e-14));
  RC_ASSERT(near_pose(project(embed(a, 0.5)), a, 0.0, 1e-15));
  RC_ASSERT(near_pose(embed(inverse(a)), inverse(embed(a)), kRounding3 * scale, 1e-14));
}

TEST(Pose3Convention, PerturbationsActOnTheRightTranslationFirst) {
  // Yaw by 90 degrees: the pose's own forward axis is the map's y.
  const Pose3 T = embed({10.0, 20.0, std::numbers::pi / 2.0}, 1.0);
  Tangent3 forward = Tangent3::Zero();
  forward[0] = 1.0;
  EXPECT_THAT(T * exp_se3(forward), PoseNear(embed({10.0, 21.0, std::numbers::pi / 2.0}, 1.0), 1e-12, 1e-12));
  Tangent3 yaw = Tangent3::Zero();
  yaw[5] = 0.1;
  EXPECT_THAT(T * exp_se3(yaw), PoseNear(embed({10.0, 20.0, std::numbers::pi / 2.0 + 0.1}, 1.0), 1e-12, 1e-12));
}

TEST(Pose3Convention, PitchUpLowersNothingForward) {
  // Right-handed about y (left): a positive pitch turns the nose down, x towards -z.
  const Pose3 T{Point3::Zero(), exp_so3({0.0, std::numbers::pi / 2.0, 0.0})};
  EXPECT_NEAR((T * Point3(1.0, 0.0, 0.0) - Point3(0.0, 0.0, -1.0)).norm(), 0.0, 1e-15);
}

TEST(Pose3Convention, PlainCases) {
  EXPECT_EQ(exp_se3(Tangent3::Zero()), Pose3{});
  EXPECT_EQ(log_se3(Pose3{}), Tangent3(Tangent3::Zero()));
  EXPECT_TRUE(Pose3{}.is_finite());
  EXPECT_FALSE((Pose3{{0.0, std::nan(""), 0.0}, Eigen::Quaterniond::Identity()}.is_finite()));
  EXPECT_FALSE((Pose3{Point3::Zero(), {HUGE_VAL, 0.0, 0.0, 0.0}}.is_finite()));
  // Exactly half a turn has two rotation vectors; either has length pi.
  EXPECT_DOUBLE_EQ(log_so3({0.0, 0.0, 0.6, 0.8}).norm(), std::numbers::pi);
}

}  // namespace
}  // namespace gdtslam
