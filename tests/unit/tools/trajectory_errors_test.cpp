// The single errors of a trajectory: some by hand, and their sums are those that the evaluation states.
#include "engine/runs/evaluation/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

Trajectory wandering(unsigned seed, double noise) {
  std::mt19937 bits(seed);
  const auto share = [&bits] { return static_cast<double>(bits()) / 4294967295.0 - 0.5; };
  Trajectory path;
  for (int k = 0; k < 200; ++k) {
    const double angle = 0.05 * k;
    path.push_back({10.0 + 0.1 * k,
                    {3.0 * std::cos(angle) + noise * share(), 2.0 * std::sin(angle) + noise * share(),
                     angle + 0.1 * noise * share()}});
  }
  return path;
}

std::vector<double> positions(const std::vector<TrajectoryError>& errors) {
  std::vector<double> values;
  for (const TrajectoryError& error : errors) values.push_back(error.position_m);
  return values;
}
std::vector<double> angles(const std::vector<TrajectoryError>& errors) {
  std::vector<double> values;
  for (const TrajectoryError& error : errors) values.push_back(error.angle_deg);
  return values;
}

TEST(TrajectoryErrors, AgainstAReferenceTheySumUpToTheAbsoluteError) {
  const Trajectory truth = wandering(1, 0.0);
  Trajectory estimate = wandering(2, 0.2);
  for (StampedPose& pose : estimate) pose.T_map_base = Pose2{1.0, -2.0, 0.7} * pose.T_map_base;  // another frame
  estimate.push_back({500.0, {}});                                                               // no counterpart
  const std::vector<TrajectoryError> errors = errors_against(estimate, truth);
  const ReferenceReport report = evaluate_reference(estimate, truth, {});
  ASSERT_EQ(errors.size(), 200U);
  EXPECT_DOUBLE_EQ(summarise(positions(errors)).rmse, report.ate_m.rmse);
  EXPECT_DOUBLE_EQ(summarise(positions(errors)).max, report.ate_m.max);
  EXPECT_DOUBLE_EQ(summarise(angles(errors)).mean, report.ate_rotation_deg.mean);
  EXPECT_EQ(errors[7].stamp_s, estimate[7].stamp_s);
}

TEST(TrajectoryErrors, OfRelationsByHand) {
  const Trajectory path{{1.0, {0.0, 0.0, 0.0}}, {2.0, {1.0, 0.0, 0.5}}, {3.0, {2.0, 1.0, 3.1}}};
  const std::vector<Relation> relations{{1.0, 2.0, {1.0, 0.3, 0.5}},   // 30 cm to the side
                                        {1.0, 3.0, {2.0, 1.0, -3.1}},  // across the jump of angles
                                        {1.0, 9.0, {0.0, 0.0, 0.0}}};  // no such stamp
  const std::vector<TrajectoryError> errors = errors_against(path, relations);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_NEAR(errors[0].position_m, 0.3, 1e-12);
  EXPECT_NEAR(errors[0].angle_deg, 0.0, 1e-12);
  EXPECT_EQ(errors[0].stamp_s, 2.0);
  EXPECT_NEAR(errors[1].position_m, 0.0, 1e-12);
  EXPECT_NEAR(errors[1].angle_deg, (2.0 * 3.14159265358979 - 6.2) * 180.0 / 3.14159265358979, 1e-9);
}

TEST(TrajectoryErrors, TheLastOfEqualStampsCounts) {
  const Trajectory truth{
      {1.0, {9.0, 9.0, 0.0}}, {1.0, {0.0, 0.0, 0.0}}, {2.0, {1.0, 0.0, 0.0}}, {3.0, {2.0, 0.0, 0.0}}};
  const Trajectory estimate{{1.0, {0.0, 0.0, 0.0}}, {2.0, {1.0, 0.0, 0.0}}, {3.0, {2.0, 0.0, 0.0}}};
  for (const TrajectoryError& error : errors_against(estimate, truth)) EXPECT_NEAR(error.position_m, 0.0, 1e-12);
}

}  // namespace
}  // namespace gdtslam
