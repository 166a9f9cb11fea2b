// Paths measured twice, by sources of which one is better than it says and the other worse.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
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

/// The places where they are, with loops that know it, a round of the square apart.
PoseGraph true_graph(const SquareDrive& drive) {
  PoseGraph graph;
  for (const std::size_t place : drive.places) graph.poses.push_back(drive.truth[place]);
  const std::size_t around = kStepsAround / kStepsBetween;
  for (std::size_t i = around; i < drive.places.size(); ++i) {
    const Pose2 T = between(graph.poses[i - around], graph.poses[i]);
    graph.loops.push_back({.relation = {i - around, i, T, Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)}});
  }
  return graph;
}

// Wheels are 0.4 of what was stated, matches twice as bad.
TEST(MeasuredPath, LoopsTellWhichSourceIsTheBetterOne) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SquareDrive drive = drive_squares(6, seed);
    for (MeasuredSteps& steps : drive.path.steps) steps[0].information = 16.0 * steps[0].information;
    MeasuredPath measured(drive.path, drive.places);
    measured.weigh(true_graph(drive));
    const auto& [front_end, wheels] = measured.factors();
    EXPECT_GT(front_end.variance, 10.0) << seed << ": stated four times as well as before";
    EXPECT_LT(wheels.variance, 0.7) << seed;
    EXPECT_LT(wheels.turn_variance, 0.7) << seed;
  }
}

// However well loops close that tie what lies near by: matches that are exact count as they are stated.
TEST(MeasuredPath, MatchesAreNotBelievedBetterThanStated) {
  SquareDrive drive = drive_squares(6, 1);
  for (std::size_t i = 1; i < drive.path.steps.size(); ++i) {
    drive.path.steps[i][0].T = between(drive.truth[i - 1], drive.truth[i]);
  }
  MeasuredPath measured(drive.path, drive.places);
  measured.weigh(true_graph(drive));
  EXPECT_DOUBLE_EQ(measured.factors()[0].variance, 1.0);
  EXPECT_DOUBLE_EQ(measured.factors()[0].turn_variance, 1.0);
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
  const std::vector<PoseRelation> cautious = measured.matches(&MeasuredStep::cautious);
  ASSERT_EQ(cautious.size(), 1U);
  EXPECT_NEAR(inverse(cautious[0].information)(0, 0), 4.0 * 3.0e-4, 1.0e-9);
  EXPECT_NEAR(inverse(measured.matches()[0].information)(0, 0), 3.0e-4, 1.0e-9);
  const std::vector<WheelRelation> doubled = measured.wheels(2.0);
  EXPECT_NEAR(inverse(doubled[0].relation.information)(0, 0), 2.0 * 3.0e-4, 1.0e-9) << "variances no less than twice";
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
    const Pose2 matched = i == 0 ? Pose2{} : exp_tangent({0.5, 0.0, turn_rad});
    drive.path.steps.push_back({MeasuredStep{matched, Matrix3::diagonal(1.0e6, 1.0e6, 1.0e8)},
                                MeasuredStep{exp_tangent(by_wheels), Matrix3::diagonal(1.0e4, 1.0e4, 1.0e6)}});
    drive.path.poses.push_back(drive.truth.back());
    if (i % 10 == 0) drive.places.push_back(i);
  }
  return drive;
}

/// What a graph finds of the wheels whose matches are as the path says.
void correct_by_graph(const SquareDrive& drive, MeasuredPath& measured) {
  PoseGraph graph;
  graph.bias_information = Matrix3::diagonal(400.0, 400.0, 400.0);
  for (int round = 0; round < 3; ++round) {
    graph.poses.clear();
    for (const std::size_t place : drive.places) graph.poses.push_back(drive.path.poses[place]);
    graph.path = measured.matches();
    graph.wheels = measured.wheels();
    graph.settle();
    measured.correct_wheels(graph);
  }
}

TEST(MeasuredPath, WheelsAreRidOfWhatTheyMissAlways) {
  for (const double way : {-0.1, 0.1}) {
    for (const double turn : {-0.1, 0.1}) {
      const SquareDrive drive = drive_bends(300, way, turn);
      MeasuredPath measured(drive.path, drive.places);
      correct_by_graph(drive, measured);
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
    MeasuredPath measured(drive.path, drive.places);
    correct_by_graph(drive, measured);
    EXPECT_NEAR(measured.wheel_bias().turn_rad_per_m, rad_per_m, 1e-3);
    EXPECT_NEAR(measured.wheel_bias().turn, 0.0, 5e-3);
    EXPECT_NEAR(measured.stretch(9, 10, StepSource::kWheels).T_from_to.theta_rad, 0.1, 1e-3);
    EXPECT_NEAR(measured.stretch(29, 30, StepSource::kWheels).T_from_to.theta_rad, -0.07, 1e-3);
  }
}

// The stated uncertainty of the distance is that of all the wheels' steps together: it shrinks with the root of their
// number, where matches know the way far better.
TEST(MeasuredPath, TheBiasIsAsUnsureAsAllStepsTogether) {
  const auto sigma_after = [](std::size_t keyframes) {
    const SquareDrive drive = drive_bends(keyframes, 0.0, 0.0);
    MeasuredPath measured(drive.path, drive.places);
    correct_by_graph(drive, measured);
    return measured.wheel_bias().sigma_distance;
  };
  const double of_step = std::sqrt(1.0e-4 + 1.0e-6) / 0.5;
  EXPECT_NEAR(sigma_after(101), of_step / 10.0, 0.1 * of_step / 10.0);
  EXPECT_NEAR(sigma_after(401), of_step / 20.0, 0.1 * of_step / 20.0);
}

// Without matches and loops the length of a way is as unsure as the scale of the wheels says: its covariance grows with
// the square of the length.
TEST(MeasuredPath, TheErrorOfALongWayGrowsWithItsLength) {
  FrontEndPath path;
  std::vector<std::size_t> places;
  PoseGraph graph;
  graph.bias_information = Matrix3::diagonal(1.0e4, 1.0e4, 1.0e4);
  for (int i = 0; i <= 100; ++i) {
    path.poses.push_back({1.0 * i, 0.0, 0.0});
    path.steps.push_back({MeasuredStep{{1.0, 0.0, 0.0}, Matrix3::diagonal(1.0e-4, 1.0e6, 1.0e8)},
                          MeasuredStep{{1.0, 0.0, 0.0}, Matrix3::diagonal(1.0e6, 1.0e6, 1.0e6)}});
    places.push_back(static_cast<std::size_t>(i));
    graph.poses.push_back(path.poses.back());
  }
  const MeasuredPath measured(path, places);
  graph.path = measured.matches();
  graph.wheels = measured.wheels();
  const GraphCovariance covariance(graph);
  EXPECT_NEAR(std::sqrt(covariance.relative(0, 50)(0, 0)), 0.5, 0.01) << "a hundredth of 50 m";
  EXPECT_NEAR(std::sqrt(covariance.relative(0, 100)(0, 0)), 1.0, 0.01);
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
  measured.state_wheel_noise(drive.truth);
  EXPECT_NEAR(sigma_of(5), kSlip_m, 0.5 * kSlip_m);
  EXPECT_NEAR(sigma_of(5), sigma_of(205), 1.0e-9) << "of two steps alike the same";
  const double by_truth = sigma_of(5);
  measured.state_wheel_noise(drive.path.poses);
  EXPECT_GT(std::fabs(sigma_of(5) - by_truth), 1.0e-6) << "what is known now counts";
  measured.state_wheel_noise(drive.truth);
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
  measured.state_wheel_noise(found);
  const double by_matches = sigma();
  EXPECT_NEAR(by_matches, kSlip_m, 0.3 * kSlip_m);
  for (WheelTravel& travel : drive.path.travels) travel.is_matched = true;
  measured.state_wheel_noise(found);
  EXPECT_LT(sigma(), 0.7 * by_matches) << "as if they had matched";
}

// What many keyframes told of the wheels stays told, wherever one is that does not.
TEST(MeasuredPath, OneKeyframeThatNothingMatchedForgetsNothingOfTheWheels) {
  constexpr double kSlip_m = 0.01;  // per root of a metre
  for (const std::size_t before_end : {5U, 25U, 100U}) {
    const SquareDrive drive =
        drive_of_slipping_wheels(kSlip_m, [&](std::size_t i) { return i + before_end != 12 * kStepsAround; });
    MeasuredPath measured(drive.path, drive.places);
    measured.state_wheel_noise(drive.truth);
    const Matrix3 covariance = inverse(measured.stretch(4, 5, StepSource::kWheels).information);
    EXPECT_NEAR(std::sqrt(covariance(0, 0)), kSlip_m, 0.3 * kSlip_m) << before_end;
  }
}

}  // namespace
}  // namespace gdtslam
