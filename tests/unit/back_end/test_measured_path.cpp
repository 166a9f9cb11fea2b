// Paths measured twice, by sources of which one is better than it says and the other worse.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/mapping/loops/measured_path.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kStepsAround = 40;  // keyframes
constexpr std::size_t kStepsBetween = 4;

/// A metre a step around a square of ten.
Pose2 square_step(std::size_t i) { return {1.0, 0.0, i % 10 == 0 ? 0.5 * kPi : 0.0}; }

MeasuredStep noisy(const Pose2& step, double real_m, double real_rad, double stated_m, double stated_rad,
                   Random& random) {
  const double x = random.normal(0.0, real_m);
  const double y = random.normal(0.0, real_m);
  const double turn = random.normal(0.0, real_rad);
  const double m = 1.0 / (stated_m * stated_m);
  return {step * exp_tangent({x, y, turn}), Matrix3::diagonal(m, m, 1.0 / (stated_rad * stated_rad))};
}

struct SquareDrive {
  std::vector<Pose2> truth;
  FrontEndPath path;
  std::vector<std::size_t> places;
};

/// A front end five times as bad as wheels, both stated alike.
SquareDrive drive_squares(std::size_t rounds, std::uint64_t seed) {
  Random random(seed);
  SquareDrive drive;
  for (std::size_t i = 0; i < rounds * kStepsAround; ++i) {
    if (i % kStepsBetween == 0) drive.places.push_back(i);
    if (i == 0) {
      drive.truth.emplace_back();
      drive.path.poses.emplace_back();
      drive.path.steps.emplace_back();
      continue;
    }
    const Pose2 step = square_step(i);
    drive.truth.push_back(drive.truth.back() * step);
    drive.path.steps.push_back(
        {noisy(step, 0.02, 0.005, 0.01, 0.002, random), noisy(step, 0.004, 0.001, 0.01, 0.002, random)});
    drive.path.poses.push_back(drive.path.poses.back() * drive.path.steps.back()[0].T);
  }
  return drive;
}

// Of a straight path with errors of heading the end's lateral variance is the sum of the squares of the ways to go.
TEST(MeasuredPath, StepsAddUpToPlaces) {
  FrontEndPath path;
  for (int i = 0; i <= 3; ++i) {
    path.poses.push_back({1.0 * i, 0.0, 0.0});
    path.steps.push_back({MeasuredStep{{1.0, 0.0, 0.0}, Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)},
                          MeasuredStep{{1.1, 0.0, 0.0}, Matrix3::diagonal(400.0, 400.0, 1.0e4)}});
  }
  const MeasuredPath measured(path, {0, 3});
  EXPECT_NEAR(measured.by_front_end(1).T_from_to.x_m, 3.0, 1.0e-12);
  EXPECT_NEAR(measured.stretch(0, 3, StepSource::kWheels).T_from_to.x_m, 3.3, 1.0e-12);
  const Matrix3 covariance = inverse(measured.by_front_end(1).information);
  EXPECT_NEAR(covariance(0, 0), 3.0e-4, 1.0e-9);
  EXPECT_NEAR(covariance(1, 1), 3.0e-4 + (4.0 + 1.0) * 1.0e-6, 1.0e-9);
  EXPECT_NEAR(covariance(2, 2), 3.0e-6, 1.0e-11);
}

TEST(MeasuredPath, LoopsTellWhichSourceIsTheBetterOne) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SquareDrive drive = drive_squares(6, seed);
    MeasuredPath measured(drive.path, drive.places);
    PoseGraph graph;
    for (const std::size_t place : drive.places) graph.poses.push_back(drive.path.poses[place]);
    const std::size_t around = kStepsAround / kStepsBetween;
    for (std::size_t i = around; i < drive.places.size(); ++i) {
      const Pose2 T = between(drive.truth[drive.places[i - around]], drive.truth[drive.places[i]]);
      graph.loops.push_back({{i - around, i, T, Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)}, 1.0});
    }
    measured.weigh(graph.loops);
    const auto& [front_end, wheels] = measured.factors();
    EXPECT_GT(front_end.variance, 5.0 * wheels.variance) << seed;
  }
}

TEST(MeasuredPath, CautiousRelationsCountTheCautiousInformation) {
  FrontEndPath path;
  for (int i = 0; i <= 3; ++i) {
    path.poses.push_back({1.0 * i, 0.0, 0.0});
    const Matrix3 stated = Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6);
    const MeasuredStep step{{1.0, 0.0, 0.0}, stated, 0.25 * stated};
    path.steps.push_back({step, step});
  }
  const MeasuredPath measured(path, {0, 3});
  const std::vector<PoseRelation> cautious = measured.cautious_relations(0.3);
  ASSERT_EQ(cautious.size(), 2U) << "of each source one";
  EXPECT_NEAR(inverse(cautious[0].information)(0, 0), 4.0 * 3.0e-4, 1.0e-9);
  const std::vector<PoseRelation> doubled = measured.cautious_relations(2.0);
  EXPECT_NEAR(inverse(doubled[0].information)(0, 0), 2.0 * 4.0 * 3.0e-4, 1.0e-9) << "variances no less than twice";
  EXPECT_NEAR(inverse(measured.relations()[0].information)(0, 0), 3.0e-4, 1.0e-9);
}

/// Loops that know where the truth is, a round of the square apart.
std::vector<Loop> true_loops(const SquareDrive& drive) {
  std::vector<Loop> loops;
  const std::size_t around = kStepsAround / kStepsBetween;
  for (std::size_t i = around; i < drive.places.size(); ++i) {
    const Pose2 T = between(drive.truth[drive.places[i - around]], drive.truth[drive.places[i]]);
    loops.push_back({{i - around, i, T, Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)}, 1.0});
  }
  return loops;
}

// What loops say of each; but where they find the front end more than ten times better than stated, both less, alike.
TEST(MeasuredPath, AFrontEndIsBelievedTenTimesBetterThanItSaysAtMost) {
  for (const double stated_too_badly : {1.0, 1.0e4}) {
    SquareDrive drive = drive_squares(6, 1);
    for (MeasuredSteps& steps : drive.path.steps) steps[0].information = 1.0 / stated_too_badly * steps[0].information;
    const std::vector<Loop> loops = true_loops(drive);
    MeasuredPath measured(drive.path, drive.places);
    const std::vector<PoseRelation> stated = measured.relations();
    const std::span<const PoseRelation> all(stated);
    const double front_end = variance_factor(all.first(stated.size() / 2), loops).variance;
    const double wheels = variance_factor(all.last(stated.size() / 2), loops).variance;
    EXPECT_EQ(front_end<0.1, stated_too_badly> 1.0);
    const double shift = front_end < 0.1 ? 0.1 / front_end : 1.0;
    measured.weigh(loops);
    EXPECT_NEAR(measured.factors()[0].variance, shift * front_end, 1e-9);
    EXPECT_NEAR(measured.factors()[1].variance, shift * wheels, 1e-9);
  }
}

/// Bends to the left and to the right, by wheels that miss a share of the way and of the turn, and a turn a metre.
SquareDrive drive_bends(std::size_t keyframes, double missing_of_way, double missing_of_turn,
                        double missing_rad_per_m = 0.0) {
  SquareDrive drive;
  for (std::size_t i = 0; i < keyframes; ++i) {
    const double turn_rad = i % 50 < 20 ? 0.1 : -0.07;
    const double way_m = 0.5 * (1.0 - missing_of_way);
    const Tangent2 by_wheels{way_m, 0.0, turn_rad * (1.0 - missing_of_turn) - missing_rad_per_m * way_m};
    drive.truth.push_back(i == 0 ? Pose2{} : drive.truth.back() * exp_tangent({0.5, 0.0, turn_rad}));
    MeasuredStep step{exp_tangent(by_wheels), Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)};
    drive.path.steps.push_back({step, step});
    drive.path.poses.push_back(drive.truth.back());
  }
  return drive;
}

TEST(MeasuredPath, WheelsAreRidOfWhatTheyMissAlways) {
  for (const double way : {-0.1, 0.1}) {
    for (const double turn : {-0.1, 0.1}) {
      const SquareDrive drive = drive_bends(300, way, turn);
      MeasuredPath measured(drive.path, {0, 299});
      measured.correct_wheels(drive.truth);
      EXPECT_NEAR(measured.wheel_bias().distance, way / (1.0 - way), 5e-3) << way << ' ' << turn;
      EXPECT_NEAR(measured.wheel_bias().turn, turn / (1.0 - turn), 5e-3) << way << ' ' << turn;
      EXPECT_NEAR(measured.wheel_bias().turn_rad_per_m, 0.0, 2e-3) << way << ' ' << turn;
      const Pose2 step = measured.stretch(9, 10, StepSource::kWheels).T_from_to;
      EXPECT_NEAR(step.x_m, exp_tangent({0.5, 0.0, 0.1}).x_m, 3e-3);
      EXPECT_NEAR(step.theta_rad, 0.1, 3e-3);
    }
  }
}

TEST(MeasuredPath, WheelsAreRidOfATurnWithEachMetre) {
  for (const double rad_per_m : {-0.02, 0.02}) {
    const SquareDrive drive = drive_bends(300, 0.0, 0.0, rad_per_m);
    MeasuredPath measured(drive.path, {0, 299});
    measured.correct_wheels(drive.truth);
    EXPECT_NEAR(measured.wheel_bias().turn_rad_per_m, rad_per_m, 1e-3);
    EXPECT_NEAR(measured.wheel_bias().turn, 0.0, 5e-3);
    EXPECT_NEAR(measured.stretch(9, 10, StepSource::kWheels).T_from_to.theta_rad, 0.1, 1e-3);
    EXPECT_NEAR(measured.stretch(29, 30, StepSource::kWheels).T_from_to.theta_rad, -0.07, 1e-3);
  }
}

// Wheels are judged by stretches of twelve steps.
TEST(MeasuredPath, OfFewerThanTwelveStepsNothingIsLearntOfWheels) {
  const auto sigma_after = [](std::size_t keyframes) {
    const SquareDrive drive = drive_bends(keyframes, 0.1, 0.1);
    MeasuredPath measured(drive.path, {0, keyframes - 1});
    measured.correct_wheels(drive.truth);
    return measured.wheel_bias().sigma_distance;
  };
  EXPECT_EQ(sigma_after(12), WheelBias{}.sigma_distance);
  EXPECT_LT(sigma_after(13), WheelBias{}.sigma_distance);
}

// At first nothing is known of wheels, so their first steps are stated as badly as any; in the end it is known better.
TEST(MeasuredPath, StatesTheFirstStepsOfWheelsWithHindsight) {
  constexpr double kSlip_m = 0.01;  // per root of a metre
  SquareDrive drive = drive_squares(8, 4);
  Random random(4);
  drive.path.travels.emplace_back();
  for (std::size_t i = 1; i < drive.path.steps.size(); ++i) {
    const double stated_m = i < 60 ? 0.3 : 0.03;
    drive.path.steps[i][1] = noisy(square_step(i), kSlip_m, 0.002, stated_m, stated_m, random);
    drive.path.travels.push_back(
        {.path_m = 1.0, .turned_rad = std::fabs(square_step(i).theta_rad), .is_way_known = true});
  }
  MeasuredPath measured(drive.path, drive.places);
  const auto sigma_of = [&](std::size_t step) {
    return std::sqrt(inverse(measured.stretch(step - 1, step, StepSource::kWheels).information)(0, 0));
  };
  EXPECT_NEAR(sigma_of(5), 0.3, 1.0e-6) << "as stated";
  measured.correct_wheels(drive.truth);
  EXPECT_NEAR(sigma_of(5), kSlip_m, 0.5 * kSlip_m);
  EXPECT_NEAR(sigma_of(5), sigma_of(205), 1.0e-9) << "of two steps alike the same";
  const double by_truth = sigma_of(5);
  measured.correct_wheels(drive.path.poses);
  EXPECT_GT(std::fabs(sigma_of(5) - by_truth), 1.0e-6) << "what is known now counts";
  measured.correct_wheels(drive.truth);
  EXPECT_EQ(sigma_of(5), by_truth) << "and what was known before does not";
}

/// Squares by wheels that slip, of keyframes that matched or not.
SquareDrive drive_of_slipping_wheels(double slip_m, const std::function<bool(std::size_t)>& is_matched) {
  SquareDrive drive = drive_squares(12, 4);
  Random random(4);
  drive.path.travels.emplace_back();
  for (std::size_t i = 1; i < drive.path.steps.size(); ++i) {
    drive.path.steps[i][1] = noisy(square_step(i), slip_m, 0.002, 0.3, 0.03, random);
    drive.path.travels.push_back({.path_m = 1.0,
                                  .turned_rad = std::fabs(square_step(i).theta_rad),
                                  .is_way_known = true,
                                  .is_matched = is_matched(i)});
  }
  return drive;
}

// Where nothing matched a keyframe lies where the wheels said: that they agree with themselves says nothing of them.
TEST(MeasuredPath, KeyframesThatTheWheelsPlacedTellNothingOfTheirNoise) {
  constexpr double kSlip_m = 0.05;  // per root of a metre
  SquareDrive drive = drive_of_slipping_wheels(kSlip_m, [](std::size_t i) { return i < 80 || i >= 360; });
  std::vector<Pose2> found{Pose2{}};
  for (std::size_t i = 1; i < drive.path.steps.size(); ++i) {
    found.push_back(found.back() * (drive.path.travels[i].is_matched ? square_step(i) : drive.path.steps[i][1].T));
  }
  MeasuredPath measured(drive.path, drive.places);
  const auto sigma = [&] { return std::sqrt(inverse(measured.stretch(4, 5, StepSource::kWheels).information)(0, 0)); };
  measured.correct_wheels(found);
  const double by_matches = sigma();
  EXPECT_NEAR(by_matches, kSlip_m, 0.3 * kSlip_m);
  for (WheelTravel& travel : drive.path.travels) travel.is_matched = true;
  measured.correct_wheels(found);
  EXPECT_LT(sigma(), 0.7 * by_matches) << "as if they had matched";
}

// What many keyframes told of the wheels stays told, wherever one is that does not.
TEST(MeasuredPath, OneKeyframeThatNothingMatchedForgetsNothingOfTheWheels) {
  constexpr double kSlip_m = 0.01;  // per root of a metre
  for (const std::size_t before_end : {5U, 25U, 100U}) {
    const SquareDrive drive =
        drive_of_slipping_wheels(kSlip_m, [&](std::size_t i) { return i + before_end != 12 * kStepsAround; });
    MeasuredPath measured(drive.path, drive.places);
    measured.correct_wheels(drive.truth);
    const Matrix3 covariance = inverse(measured.stretch(4, 5, StepSource::kWheels).information);
    EXPECT_NEAR(std::sqrt(covariance(0, 0)), kSlip_m, 0.3 * kSlip_m) << before_end;
  }
}

// Keyframes laid by the wheels are as short as these are.
TEST(MeasuredPath, KeyframesThatTheWheelsPlacedTellNothingOfTheirScale) {
  constexpr double kMissing = 0.05;  // of the way
  SquareDrive drive = drive_bends(300, kMissing, 0.0);
  std::vector<Pose2> found{Pose2{}};
  drive.path.travels.emplace_back();
  for (std::size_t i = 1; i < drive.path.steps.size(); ++i) {
    const bool is_matched = i < 100;
    drive.path.travels.push_back({.path_m = 0.5, .turned_rad = 0.1, .is_way_known = true, .is_matched = is_matched});
    found.push_back(found.back() *
                    (is_matched ? between(drive.truth[i - 1], drive.truth[i]) : drive.path.steps[i][1].T));
  }
  MeasuredPath measured(drive.path, {0, 299});
  measured.correct_wheels(found);
  EXPECT_NEAR(measured.wheel_bias().distance, kMissing / (1.0 - kMissing), 5e-3);
}

}  // namespace
}  // namespace gdtslam
