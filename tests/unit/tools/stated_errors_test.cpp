// Whether errors are as large as is stated: poses drawn from known covariances, theory from closed forms.
#include "engine/runs/evaluation/errors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kTrials = 20000;
constexpr double kFiveDeviations = 5.0 * 0.5 / 141.0;  // of a share of that many trials: sqrt(p (1 - p) / n), p = 1/2

// Of chi-square with three degrees of freedom within k^2, and with two.
double within_in_space(double k) {
  return std::erf(k / std::sqrt(2.0)) - std::sqrt(2.0 / kPi) * k * std::exp(-0.5 * k * k);
}
double within_in_plane(double k) { return 1.0 - std::exp(-0.5 * k * k); }

// x and y vary together, and the heading with both: rows of a lower triangular root, small enough to be linear.
class StatedErrorsOfDraws : public testing::Test {
 protected:
  Pose2 drawn(const Pose2& truth) {
    const double a = random_.normal();
    const double b = random_.normal();
    const double c = random_.normal();
    return {truth.x_m + 0.003 * a, truth.y_m + 0.001 * a + 0.002 * b,
            truth.theta_rad + 1.0e-4 * (2.0 * a - 3.0 * b + 4.0 * c)};
  }
  const PoseCovariance covariance_{.xx = 9.0e-6, .xy = 3.0e-6, .xt = 6.0e-7, .yy = 5.0e-6, .yt = -4.0e-7, .tt = 2.9e-7};
  Random random_{7};
};

void expect_shares(const StatedShares& shares, const StatedTheory& theory, double scale) {
  EXPECT_EQ(shares.count, kTrials);
  const bool is_plane = theory.median < 2.0;
  for (std::size_t k = 1; k <= kStatedSigmas; ++k) {
    const double at = scale * static_cast<double>(k);
    EXPECT_NEAR(shares.share(k), is_plane ? within_in_plane(at) : within_in_space(at), kFiveDeviations) << k;
  }
  EXPECT_NEAR(shares.factor * scale, 1.0, 0.05);
}

TEST_F(StatedErrorsOfDraws, PosesAgainstTheTruth) {
  const Pose2 T_reference_map{3.0, -2.0, 1.1};
  Trajectory truth;
  Trajectory estimate;
  for (std::size_t i = 0; i < kTrials; ++i) {
    const Pose2 pose{10.0 * random_.uniform(), 10.0 * random_.uniform(), 6.0 * random_.uniform() - 3.0};
    truth.push_back({static_cast<double>(i), T_reference_map * pose});
    estimate.push_back({static_cast<double>(i), drawn(pose)});
  }
  const auto report = [&](double share) {
    PoseCovariance stated = covariance_;
    for (double* value : {&stated.xx, &stated.xy, &stated.xt, &stated.yy, &stated.yt, &stated.tt}) *value *= share;
    return stated_errors(estimate, std::vector<PoseCovariance>(kTrials, stated), truth, T_reference_map, {}, 0.1);
  };
  expect_shares(report(1.0).pose, kPoseTheory, 1.0);
  expect_shares(report(1.0).position, kPositionTheory, 1.0);
  expect_shares(report(0.25).pose, kPoseTheory, 0.5);  // stated deviations half as large as they should be
  expect_shares(report(4.0).position, kPositionTheory, 2.0);
}

TEST_F(StatedErrorsOfDraws, RelationsBetweenPosesThatErrApart) {
  Trajectory estimate;
  std::vector<Relation> relations;
  for (std::size_t i = 0; i < kTrials; ++i) {
    const Pose2 first{10.0 * random_.uniform(), 10.0 * random_.uniform(), 6.0 * random_.uniform() - 3.0};
    const Pose2 second = first * Pose2{4.0 * random_.uniform(), 3.0, 2.0 * random_.uniform()};
    const auto stamp_s = static_cast<double>(2 * i);
    relations.push_back({stamp_s, stamp_s + 1.0, between(first, second)});
    estimate.push_back({stamp_s, drawn(first)});
    estimate.push_back({stamp_s + 1.0, drawn(second)});
  }
  const std::vector<PoseCovariance> stated(2 * kTrials, covariance_);
  const StatedReport report = stated_errors(estimate, stated, relations, {});
  expect_shares(report.pose, kPoseTheory, 1.0);
  expect_shares(report.position, kPositionTheory, 1.0);
  // Noise of the relations themselves counts with that of the poses.
  const TruthNoise noise{.sigma_m = 0.01, .sigma_rad = 0.002};
  for (Relation& relation : relations) {
    relation.T_1_2.x_m += noise.sigma_m * random_.normal();
    relation.T_1_2.y_m += noise.sigma_m * random_.normal();
    relation.T_1_2.theta_rad += noise.sigma_rad * random_.normal();
  }
  expect_shares(stated_errors(estimate, stated, relations, noise).pose, kPoseTheory, 1.0);
  EXPECT_GT(stated_errors(estimate, stated, relations, {}).position.factor, 1.5);
}

TEST(StatedErrors, WithoutADeviationThereIsNothingToCompareWith) {
  const Trajectory trajectory{{0.0, {}}, {1.0, {1.0, 0.0, 0.0}}};
  const std::vector<PoseCovariance> none(2);
  const std::vector<Relation> relations{{0.0, 1.0, {1.1, 0.0, 0.0}}, {0.0, 5.0, {}}};
  const StatedReport report = stated_errors(trajectory, none, relations, {});
  EXPECT_EQ(report.unstated, 1U);
  EXPECT_EQ(report.pose.count, 0U);
  // A tenth of a metre off, which is 1.6 times 6.25 cm.
  const StatedReport with_noise = stated_errors(trajectory, none, relations, {0.0625, 0.02});
  EXPECT_EQ(with_noise.position.within, (std::array<std::uint64_t, 3>{0, 1, 1}));
}

}  // namespace
}  // namespace gdtslam
