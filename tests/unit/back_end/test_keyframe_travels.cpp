// What the back end adds up of the scans between two keyframes, and begins anew at each.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/mapping/back_end/back_end.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

// Wheels are never better than 2 mm and half a milliradian.
constexpr double kLeastOfPlace = 4.0e-6;  // square metres
constexpr double kLeastOfTurn = 2.5e-7;   // square radians

/// Steps of a robot whose matches are where its wheels said, but for what a step is told to be off.
class Travel : public testing::Test {
 protected:
  Travel() : back_end_(without_thread()) { take(true); }

  static BackEndOptions without_thread() {
    BackEndOptions options;
    options.live.is_beside = false;
    return options;
  }
  void take(bool is_keyframe, const Pose2& step = {}, double sigma_m = 0.01, double sigma_rad = 0.001,
            const Pose2& off = {}, bool is_matched = true) {
    MatchResult result;
    result.T_odometry_step = step;
    result.T_map_predicted = T_map_base_ * step;
    T_map_base_ = result.T_map_predicted * off;
    result.T_map_base = T_map_base_;
    result.odometry_sigma_m = result.predicted_sigma_m = sigma_m;
    result.odometry_sigma_rad = result.predicted_sigma_rad = sigma_rad;
    result.accepted = is_matched;
    result.merged = is_keyframe;
    back_end_.take({}, result);
    taken_.push_back(T_map_base_);
  }
  /// To be asked for at the end.
  const FrontEndPath& path() {
    (void)back_end_.loops().end([](double) {});
    result_ = back_end_.as_driven();
    return back_end_.loops().path();
  }
  static Matrix3 wheels_covariance(const FrontEndPath& path, std::size_t keyframe) {
    return inverse(path.steps[keyframe][1].information);
  }

  BackEnd back_end_;
  BackEndResult result_;
  Pose2 T_map_base_;
  std::vector<Pose2> taken_;
};

TEST_F(Travel, WaysAndTurnsAddUpFromKeyframeToKeyframe) {
  take(false, {0.3, 0.0, 0.2});
  take(false, {-0.3, 0.4, -0.1});
  take(true, {0.0, 0.0, 0.05});
  take(true, {0.7, 0.0, -0.3});
  take(true);
  const FrontEndPath& found = path();
  ASSERT_EQ(found.travels.size(), 4U);
  EXPECT_EQ(found.travels[0].path_m, 0.0);
  EXPECT_NEAR(found.travels[1].path_m, 0.3 + 0.5, 1e-12);
  EXPECT_NEAR(found.travels[1].turned_rad, 0.2 + 0.1 + 0.05, 1e-12);
  EXPECT_NEAR(found.travels[2].path_m, 0.7, 1e-12);
  EXPECT_NEAR(found.travels[2].turned_rad, 0.3, 1e-12);
  EXPECT_EQ(found.travels[3].path_m, 0.0);
  EXPECT_EQ(found.travels[3].turned_rad, 0.0);
  for (std::size_t k = 1; k < 4; ++k) {
    EXPECT_TRUE(found.travels[k].is_measured);
    EXPECT_NEAR(found.travels[k].besides(0, 0), kLeastOfPlace, 1e-15);
    EXPECT_NEAR(found.travels[k].besides(2, 2), kLeastOfTurn, 1e-16);
  }
}

TEST_F(Travel, AKeyframeWithoutAMatchIsTold) {
  take(true, {1.0, 0.0, 0.0}, 0.01, 0.001, {}, false);
  take(true, {1.0, 0.0, 0.0});
  const FrontEndPath& found = path();
  EXPECT_TRUE(found.travels[0].is_matched);
  EXPECT_FALSE(found.travels[1].is_matched);
  EXPECT_TRUE(found.travels[2].is_matched);
}

TEST_F(Travel, ThePathIsTheWayFromKeyframeToKeyframe) {
  take(false, {1.0, 0.0, 0.0});
  take(true, {0.0, 1.0, 0.0});
  take(true, {-3.0, 0.0, 0.0});
  take(true, {0.0, 0.0, 1.0});
  const FrontEndPath& found = path();
  const std::vector<double> expected{0.0, std::sqrt(2.0), std::sqrt(2.0) + 3.0, std::sqrt(2.0) + 3.0};
  ASSERT_EQ(found.path_m.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(found.path_m[k], expected[k], 1e-12);
  EXPECT_EQ(result_.keyframes, (std::vector<std::size_t>{0, 2, 3, 4}));
}

TEST_F(Travel, EachScanIsWhereItWasTaken) {
  take(false, {0.3, 0.1, 0.2});
  take(true, {0.3, -0.1, 0.2});
  take(false, {0.1, 0.0, -0.9});
  take(false, {0.1, 0.2, 0.0});
  (void)path();
  ASSERT_EQ(result_.poses.size(), taken_.size());
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    EXPECT_NEAR(length_of(between(taken_[i], result_.poses[i])), 0.0, 1e-12) << i;
    EXPECT_NEAR(result_.poses[i].theta_rad, taken_[i].theta_rad, 1e-12) << i;
  }
}

// A step that is less sure than 5 m none has measured: it counts as no way, and what it may be off besides the rest.
TEST_F(Travel, AStepThatNothingMeasuredIsNoWayOfTheWheels) {
  const double nearly_m = std::nextafter(5.0, 0.0);
  take(true, {1.0, 0.0, 0.1}, nearly_m, 0.2);
  take(false, {1.0, 0.0, 0.1}, 5.0, 0.2);
  take(true, {0.5, 0.0, 0.0});
  take(true, {0.25, 0.0, 0.0});
  const FrontEndPath& found = path();
  EXPECT_TRUE(found.travels[1].is_measured);
  EXPECT_NEAR(found.travels[1].path_m, 1.0, 1e-12);
  EXPECT_NEAR(found.travels[1].besides(0, 0), kLeastOfPlace, 1e-15);
  EXPECT_FALSE(found.travels[2].is_measured);
  EXPECT_NEAR(found.travels[2].path_m, 0.5, 1e-12);
  EXPECT_EQ(found.travels[2].turned_rad, 0.0);
  EXPECT_NEAR(found.travels[2].besides(0, 0), 25.0 + kLeastOfPlace, 1e-12);
  EXPECT_NEAR(found.travels[2].besides(1, 1), 25.0 + kLeastOfPlace, 1e-12);
  EXPECT_NEAR(found.travels[2].besides(2, 2), 0.04 + kLeastOfTurn, 1e-12);
  EXPECT_TRUE(found.travels[3].is_measured) << "begun anew";
  EXPECT_NEAR(found.travels[3].besides(0, 0), kLeastOfPlace, 1e-15);
}

// A heading that is off after the first step carries the second aside by its length, to the side of its sign.
TEST_F(Travel, WheelsErrAsidesByWhatTheirHeadingErredBefore) {
  constexpr double kSigma_m = 0.01;
  constexpr double kSigma_rad = 0.02;
  const std::vector<Pose2> second{{1.5, 0.0, 0.0}, {-1.5, 0.0, 0.0}, {0.0, 1.5, 0.0}};
  for (const Pose2& step : second) {
    take(false, {1.0, 0.0, 0.0}, kSigma_m, kSigma_rad);
    take(true, step, kSigma_m, kSigma_rad);
  }
  const FrontEndPath& found = path();
  for (std::size_t k = 0; k < second.size(); ++k) {
    const double x = second[k].x_m;
    const double y = second[k].y_m;
    const Matrix3 covariance = wheels_covariance(found, k + 1);
    const double sq_m = 2.0 * kSigma_m * kSigma_m + kLeastOfPlace;
    const double sq_rad = kSigma_rad * kSigma_rad;
    EXPECT_NEAR(covariance(0, 0), sq_m + y * y * sq_rad, 1e-9) << k;
    EXPECT_NEAR(covariance(1, 1), sq_m + x * x * sq_rad, 1e-9) << k;
    EXPECT_NEAR(covariance(2, 2), 2.0 * sq_rad + kLeastOfTurn, 1e-9) << k;
    EXPECT_NEAR(covariance(1, 2), x * sq_rad, 1e-9) << k;
    EXPECT_NEAR(covariance(0, 2), -y * sq_rad, 1e-9) << k;
    const Pose2 whole = Pose2{1.0, 0.0, 0.0} * second[k];
    EXPECT_NEAR(length_of(between(whole, found.steps[k + 1][1].T)), 0.0, 1e-12) << "of this step alone";
  }
}

// A leap of 0.3 rad, and 2 m more: either of the two may be wrong by that, and by 0.6 m aside.
TEST_F(Travel, ALeapIsCarriedToTheKeyframeAndForgottenBehindIt) {
  for (const double leap_rad : {-0.3, 0.3}) {
    take(false, {1.0, 0.0, 0.0}, 0.0, 0.0, {0.0, 0.0, leap_rad});
    take(true, {2.0, 0.0, 0.0}, 0.0, 0.0);
    take(true, {2.0, 0.0, 0.0}, 0.0, 0.0);
  }
  const FrontEndPath& found = path();
  for (const std::size_t k : {1U, 3U}) {
    for (const Matrix3& leapt : {wheels_covariance(found, k), found.travels[k].besides}) {
      EXPECT_NEAR(leapt(0, 0), kLeastOfPlace, 1e-9);
      EXPECT_NEAR(leapt(1, 1), 0.36 + kLeastOfPlace, 1e-6);
      EXPECT_NEAR(leapt(1, 2), 0.18, 1e-6);
      EXPECT_NEAR(leapt(2, 2), 0.09 + kLeastOfTurn, 1e-6);
    }
    const Matrix3 after = wheels_covariance(found, k + 1);
    EXPECT_NEAR(after(1, 1), kLeastOfPlace, 1e-12);
    EXPECT_NEAR(after(2, 2), kLeastOfTurn, 1e-12);
    EXPECT_NEAR(found.travels[k + 1].besides(1, 1), kLeastOfPlace, 1e-12);
  }
}

TEST(TravelOfTheFirstScan, IsAKeyframeWhetherItWasMergedOrNot) {
  BackEndOptions options;
  options.live.is_beside = false;
  BackEnd back_end(options);
  back_end.take({}, {});
  back_end.take({}, {});
  const BackEndResult result = back_end.as_driven();
  EXPECT_EQ(result.keyframes, std::vector<std::size_t>{0});
  EXPECT_EQ(result.poses.size(), 2U);
  EXPECT_FALSE(result.is_closed);
}

}  // namespace
}  // namespace gdtslam
