// Stamps that are in no order, step back or are all one: what evaluate_reference() makes of them, by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {
namespace {

// Along a straight line the estimate is a hundredth too long: a metre of path is 1 cm off, in whichever order the rows
// come. Of twenty poses 0.5 m apart all but the last two have one a metre on.
TEST(EvaluateReference, RowsNeedNotBeInTheOrderOfTime) {
  Trajectory estimate;
  Trajectory reference;
  for (int k = 0; k < 20; ++k) {
    estimate.push_back({0.1 * k, {0.505 * k, 0, 0}});
    reference.push_back({0.1 * k, {0.5 * k, 0, 0}});
  }
  const auto expect_a_centimetre = [&](const Trajectory& rows, const Trajectory& truth) {
    const ReferenceReport report = evaluate_reference(rows, truth, {.rpe_distance_m = 1.0});
    EXPECT_EQ(report.rpe_m.count, 18U);
    EXPECT_NEAR(report.rpe_m.max, 0.01, 1e-9);
    EXPECT_NEAR(report.rpe_m.mean, 0.01, 1e-9);
  };
  expect_a_centimetre(estimate, reference);
  Trajectory shuffled;
  for (std::size_t k = 0; k < 20; ++k) shuffled.push_back(estimate[7 * k % 20]);
  expect_a_centimetre(shuffled, reference);
  Trajectory shuffled_reference;
  for (std::size_t k = 0; k < 20; ++k) shuffled_reference.push_back(reference[3 * k % 20]);
  expect_a_centimetre(estimate, shuffled_reference);
  expect_a_centimetre(shuffled, shuffled_reference);
  std::reverse(estimate.begin(), estimate.end());
  expect_a_centimetre(estimate, reference);
}

// As the public Intel log has it: the clock was set back by three poses, and the rows are right.
TEST(EvaluateReference, AClockThatStepsBackLeavesTheRowsInTheirOrder) {
  Trajectory estimate;
  Trajectory reference;
  for (int k = 0; k < 20; ++k) {
    const double stamp_s = k < 10 ? k : k - 3.5;
    estimate.push_back({stamp_s, {0.505 * k, 0, 0}});
    reference.push_back({stamp_s, {0.5 * k, 0, 0}});
  }
  const ReferenceReport report = evaluate_reference(estimate, reference, {.rpe_distance_m = 1.0});
  EXPECT_EQ(report.rpe_m.count, 18U);
  EXPECT_NEAR(report.rpe_m.max, 0.01, 1e-9);
}

// Three poses a metre apart of one stamp would each be held against the last of them: errors of up to two metres for a
// trajectory that is its own reference.
TEST(EvaluateReference, StampsThatAreAllOneAreAnError) {
  const Trajectory still_clock{{5.0, {}}, {5.0, {1.0, 0.0, 0.0}}, {5.0, {2.0, 0.0, 0.0}}};
  try {
    static_cast<void>(evaluate_reference(still_clock, still_clock, {}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the 3 poses whose stamps occur in the reference all meet one pose"));
  }
  Trajectory moves_on = still_clock;
  moves_on[2].stamp_s = 6.0;
  EXPECT_EQ(evaluate_reference(moves_on, moves_on, {}).matched, 3U);
}

}  // namespace
}  // namespace gdtslam
