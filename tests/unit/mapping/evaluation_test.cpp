// Expected values are derived by hand from the definitions in evaluation.hpp, or published: the figures of raw odometry
// on the public logs.
#include "gdtslam/mapping/evaluation.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <ostream>
#include <string>
#include <variant>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "support/real_data.hpp"

namespace gdtslam {
namespace {

constexpr double kTiny = 1e-12;

TEST(Summarise, MatchesHandCalculation) {
  // Mean 3, squared deviations 4 + 1 + 0 + 9 - over n - 1 = 3; squares 1 + 4 + 9 + 36 over 4.
  const ErrorSummary s = summarise({6.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(14.0 / 3.0));
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 6.0);
}

TEST(Summarise, OneErrorHasNoDeviationAndNoneIsZero) {
  const ErrorSummary one = summarise({0.5});
  EXPECT_DOUBLE_EQ(one.mean, 0.5);
  EXPECT_DOUBLE_EQ(one.median, 0.5);
  EXPECT_EQ(one.deviation, 0.0);
  EXPECT_EQ(summarise({}).count, 0u);
  EXPECT_EQ(summarise({}).mean, 0.0);
}

TEST(EvaluateRelations, ComparesTheMotionInTheFrameOfTheFirstPose) {
  // At t = 1 the robot stands at (1, 2) and looks along +y; at t = 2 it stands 3 m ahead and 0.5 m to its left, turned
  // left by 90 degrees: (0.5, 5) in the map, heading pi. In its own frame the motion is (3, 0.5), 90 degrees.
  const Trajectory trajectory{{1.0, {1.0, 2.0, kPi / 2}}, {2.0, {0.5, 5.0, kPi}}};
  const Relation relation{1.0, 2.0, {3.0 - 0.3, 0.5 + 0.4, kPi / 2 - rad_from_deg(2.0)}};
  const RelationReport report = evaluate_relations(trajectory, {&relation, 1});
  EXPECT_EQ(report.all.translation_m.count, 1u);
  EXPECT_NEAR(report.all.translation_m.mean, 0.5, kTiny);  // a 3-4-5 triangle
  EXPECT_NEAR(report.all.rotation_deg.mean, 2.0, 1e-10);
  EXPECT_EQ(report.unmatched, 0u);
}

TEST(EvaluateRelations, YawErrorIsWrapped) {
  const Trajectory trajectory{{1.0, {}}, {2.0, {0.0, 0.0, rad_from_deg(179.0)}}};
  const Relation relation{1.0, 2.0, {0.0, 0.0, rad_from_deg(-179.0)}};
  EXPECT_NEAR(evaluate_relations(trajectory, {&relation, 1}).all.rotation_deg.mean, 2.0, 1e-10);
}

TEST(EvaluateRelations, SplitsAtTwentySeconds) {
  const Trajectory trajectory{{0.0, {}}, {20.0, {1.0, 0.0, 0.0}}, {20.5, {3.0, 0.0, 0.0}}};
  const Relation relations[] = {{0.0, 20.0, {}}, {0.0, 20.5, {}}, {20.5, 0.0, {}}};
  const RelationReport report = evaluate_relations(trajectory, relations);
  EXPECT_EQ(report.short_term.translation_m.count, 1u);
  EXPECT_DOUBLE_EQ(report.short_term.translation_m.mean, 1.0);
  EXPECT_EQ(report.loops.translation_m.count, 2u);
  EXPECT_DOUBLE_EQ(report.loops.translation_m.mean, 3.0);
  EXPECT_EQ(report.all.translation_m.count, 3u);
  EXPECT_EQ(report.worst_t1_s, 0.0);
  EXPECT_EQ(report.worst_t2_s, 20.5);
}

TEST(EvaluateRelations, LastPoseOfADuplicateStampCounts) {
  const Trajectory trajectory{{5.0, {9.0, 9.0, 0.0}}, {1.0, {}}, {5.0, {2.0, 0.0, 0.0}}, {3.0, {7.0, 0.0, 0.0}}};
  const Relation forward{1.0, 5.0, {2.0, 0.0, 0.0}};
  EXPECT_EQ(evaluate_relations(trajectory, {&forward, 1}).all.translation_m.max, 0.0);
  // The same when the search comes from below the stamp, within the tolerance.
  const Relation below{1.0, 5.0 - 5e-5, {2.0, 0.0, 0.0}};
  EXPECT_EQ(evaluate_relations(trajectory, {&below, 1}).all.translation_m.max, 0.0);
}

TEST(EvaluateRelations, TakesTheNearestStampWithinTheTolerance) {
  const Trajectory trajectory{{0.0, {}}, {1.0, {1.0, 0.0, 0.0}}, {1.1, {2.0, 0.0, 0.0}}};
  const auto error_at = [&trajectory](double t2_s, double tolerance_s) {
    const Relation relation{0.0, t2_s, {}};
    const RelationReport report = evaluate_relations(trajectory, {&relation, 1}, tolerance_s);
    return report.unmatched == 1 ? -1.0 : report.all.translation_m.mean;
  };
  EXPECT_EQ(error_at(1.04, 0.06), 1.0);
  EXPECT_EQ(error_at(1.06, 0.06), 2.0);
  EXPECT_EQ(error_at(1.04, 0.03), -1.0);
  EXPECT_EQ(error_at(-0.01, 0.02), 0.0);
  EXPECT_EQ(error_at(1.13, 0.02), -1.0);
}

TEST(EvaluateRelations, EmptyInputsGiveNoErrorsAndStampsThatAreNoNumbersNeverMatch) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Relation relation{nan, 1.0, {}};
  EXPECT_EQ(evaluate_relations({}, {&relation, 1}).unmatched, 1u);
  EXPECT_EQ(evaluate_relations({{nan, {}}, {1.0, {}}}, {&relation, 1}).unmatched, 1u);
  EXPECT_EQ(evaluate_relations({}, {}).all.translation_m.count, 0u);
}

// A clock that is set back by ten seconds: of twenty stamps those from 5 to 9 occur twice.
TEST(RepeatedStamps, AreThoseOfTwoStretches) {
  Trajectory trajectory;
  for (int k = 0; k < 15; ++k) trajectory.push_back({static_cast<double>(k), {}});
  for (int k = 5; k < 10; ++k) trajectory.push_back({static_cast<double>(k), {}});
  const RepeatedStamps repeated(trajectory, 0.25);
  for (int k = -1; k < 16; ++k) EXPECT_EQ(repeated.have(k), k >= 5 && k < 10) << k;
  EXPECT_TRUE(repeated.have(4.75) && repeated.have(9.25));
  EXPECT_FALSE(repeated.have(4.74) || repeated.have(9.26));
  EXPECT_FALSE(repeated.have(std::numeric_limits<double>::quiet_NaN()));
  const std::vector<Relation> relations{{1.0, 2.0, {}}, {1.0, 5.0, {}}, {9.0, 12.0, {}}, {4.0, 10.0, {}}};
  const std::vector<Relation> clear = without_repeated_stamps(relations, trajectory);
  ASSERT_EQ(clear.size(), 2u);
  EXPECT_EQ(clear[0].t2_s, 2.0);
  EXPECT_EQ(clear[1].t1_s, 4.0);
}

// A recorder that stamps what it receives steps back by less than a second, and stamps of one drive that occur twice
// are no question of which.
TEST(RepeatedStamps, AreNoneWithinOneStretch) {
  const Trajectory trajectory{{0.0, {}}, {1.0, {}}, {1.0, {}}, {0.5, {}}, {1.5, {}}};
  const RepeatedStamps repeated(trajectory, 1.0);
  for (const double stamp_s : {0.0, 0.5, 1.0, 1.5}) EXPECT_FALSE(repeated.have(stamp_s));
}

Trajectory random_walk(Random& random, std::size_t poses) {
  Trajectory walk;
  Pose2 pose;
  for (std::size_t k = 0; k < poses; ++k) {
    walk.push_back({static_cast<double>(k), pose});
    pose = pose * Pose2{random.uniform(0.0, 0.4), random.uniform(-0.1, 0.1), random.uniform(-0.5, 0.5)};
  }
  return walk;
}

Trajectory moved(const Pose2& T, const Trajectory& trajectory) {
  Trajectory result = trajectory;
  for (StampedPose& pose : result) pose.T_map_base = T * pose.T_map_base;
  return result;
}

// The truth against itself has no errors, whatever its clock did; one whose stamps occur twice tells nothing of one
// whose do not.
TEST(EvaluateReference, StretchesOfAClockThatStepsBackAreMatchedOneByOne) {
  Random random(11);
  Trajectory walk = random_walk(random, 90);
  const Trajectory sound = walk;
  for (std::size_t k = 40; k < walk.size(); ++k) walk[k].stamp_s -= 20.0;
  const ReferenceReport report = evaluate_reference(walk, walk, {});
  EXPECT_EQ(report.matched, 90U);
  EXPECT_NEAR(report.ate_m.max, 0.0, 1e-9);
  EXPECT_NEAR(report.rpe_m.max, 0.0, 1e-9);
  const auto refusal = [](const Trajectory& estimate, const Trajectory& reference) -> std::string {
    try {
      static_cast<void>(evaluate_reference(estimate, reference, {}));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  // Stamps 20 to 39 were passed twice.
  EXPECT_THAT(refusal(sound, walk), testing::HasSubstr("20 stamps occur twice, a clock stepped back"));
  // Two drives at one time, of which the reference has the times: each pose meets the one of its stamp.
  EXPECT_EQ(refusal(walk, sound), "accepted");
}

TEST(EvaluateReference, ATrajectoryThatGoesBackwardInTimeHasNoStampTwice) {
  Random random(12);
  Trajectory walk = random_walk(random, 50);
  const Trajectory sound = walk;
  std::reverse(walk.begin(), walk.end());
  EXPECT_NEAR(evaluate_reference(walk, sound, {}).ate_m.max, 0.0, 1e-9);
  EXPECT_NEAR(evaluate_reference(sound, walk, {}).ate_m.max, 0.0, 1e-9);
}

// What the relations say does not depend on where the map's origin is.
TEST(EvaluateRelations, IsInvariantUnderAMotionOfTheMap) {
  Random random(7);
  const Trajectory walk = random_walk(random, 60);
  std::vector<Relation> relations;
  for (int k = 0; k < 40; ++k) {
    relations.push_back({static_cast<double>(k),
                         static_cast<double>(59 - k),
                         {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-3.0, 3.0)}});
  }
  const RelationReport before = evaluate_relations(walk, relations);
  const RelationReport after = evaluate_relations(moved({12.5, -3.0, 2.0}, walk), relations);
  EXPECT_NEAR(before.all.translation_m.mean, after.all.translation_m.mean, 1e-9);
  EXPECT_NEAR(before.all.rotation_deg.rmse, after.all.rotation_deg.rmse, 1e-9);
  EXPECT_NEAR(before.loops.translation_m.deviation, after.loops.translation_m.deviation, 1e-9);
}

TEST(EvaluateReference, AlignmentRecoversTheMotionBetweenTheMaps) {
  Random random(11);
  const Trajectory reference = random_walk(random, 50);
  const Pose2 T_reference_estimate{3.0, -1.5, 2.5};
  const ReferenceReport report = evaluate_reference(moved(inverse(T_reference_estimate), reference), reference, {});
  EXPECT_NEAR(report.T_reference_estimate.x_m, 3.0, 1e-9);
  EXPECT_NEAR(report.T_reference_estimate.y_m, -1.5, 1e-9);
  EXPECT_NEAR(report.T_reference_estimate.theta_rad, 2.5, 1e-9);
  EXPECT_LT(report.ate_m.max, 1e-9);
  EXPECT_LT(report.ate_rotation_deg.max, 1e-9);
  EXPECT_LT(report.rpe_m.max, 1e-9);
  EXPECT_EQ(report.matched, 50u);
}

TEST(EvaluateReference, HandDerivedSquare) {
  // Corners of a square of side 2 against the same square stretched to 4 along x: without scale the best alignment is
  // the common centre, every corner then 1 m off.
  const Trajectory estimate{{0, {0, 0, 0}}, {1, {2, 0, 0}}, {2, {2, 2, 0}}, {3, {0, 2, 0}}};
  const Trajectory reference{{0, {0, 0, 0}}, {1, {4, 0, 0}}, {2, {4, 2, 0}}, {3, {0, 2, 0}}};
  const ReferenceReport report = evaluate_reference(estimate, reference, {.rpe_distance_m = 4.0});
  EXPECT_NEAR(report.ate_m.mean, 1.0, kTiny);
  EXPECT_NEAR(report.ate_m.deviation, 0.0, 1e-7);
  // Relative motions along at least 4 m of reference path: 0 to 1 (4 m, error 2), 1 to 3 (6 m, error 2); from corner 2
  // there are exactly 4 m to corner 3 (error 2).
  EXPECT_EQ(report.rpe_m.count, 3u);
  EXPECT_NEAR(report.rpe_m.mean, 2.0, kTiny);
}

TEST(EvaluateReference, WithoutAlignmentTheFirstPosesAgree) {
  const Trajectory estimate{{0, {0, 0, kPi / 2}}, {1, {0, 1, kPi / 2}}};
  const Trajectory reference{{0, {5, 5, 0}}, {1, {6.25, 5, 0}}};
  const ReferenceReport report = evaluate_reference(estimate, reference, {.align = false});
  EXPECT_NEAR(report.ate_m.max, 0.25, kTiny);
  EXPECT_NEAR(report.ate_m.mean, 0.125, kTiny);
  EXPECT_NEAR(report.ate_rotation_deg.max, 0.0, 1e-10);
}

// The mean of seven times 0.1 is not 0.1: what rounding leaves of the offsets must not decide the rotation.
TEST(EvaluateReference, EqualPositionsThatDoNotAverageExactlyAreAlignedByTheHeadings) {
  Trajectory estimate;
  Trajectory reference;
  for (int k = 0; k < 7; ++k) {
    estimate.push_back({static_cast<double>(k), {0.1, 0.2, 0.3 * k}});
    reference.push_back({static_cast<double>(k), {0.3, 0.7, 0.3 * k}});
  }
  const ReferenceReport report = evaluate_reference(estimate, reference, {});
  EXPECT_NEAR(report.T_reference_estimate.theta_rad, 0.0, kTiny);
  EXPECT_NEAR(report.ate_rotation_deg.max, 0.0, 1e-10);
  EXPECT_NEAR(report.ate_m.max, 0.0, kTiny);
}

// The estimate of a robot that stands trembles, which tells nothing about the rotation either.
TEST(EvaluateReference, ARobotThatStandsIsAlignedByTheHeadings) {
  Random random(3);
  Trajectory estimate;
  Trajectory reference;
  for (int k = 0; k < 40; ++k) {
    estimate.push_back({static_cast<double>(k), {0.002 * random.normal(), 0.002 * random.normal(), 0.0}});
    reference.push_back({static_cast<double>(k), {3.0, 1.0, 2.0}});
  }
  EXPECT_NEAR(evaluate_reference(estimate, reference, {}).T_reference_estimate.theta_rad, 2.0, 1e-12);
  EXPECT_NEAR(evaluate_reference(reference, estimate, {}).T_reference_estimate.theta_rad, -2.0, 1e-12);
}

// Perturbing the alignment in any direction must not lower the sum of squares: it is the minimum.
TEST(EvaluateReference, AlignmentIsOptimal) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const Trajectory reference = random_walk(random, 30);
    const Trajectory estimate = random_walk(random, 30);
    const Pose2 best = evaluate_reference(estimate, reference, {}).T_reference_estimate;
    const auto cost = [&estimate, &reference](const Pose2& T) {
      double sum = 0.0;
      for (std::size_t k = 0; k < estimate.size(); ++k) {
        sum += (T * estimate[k].T_map_base.translation() - reference[k].T_map_base.translation()).squaredNorm();
      }
      return sum;
    };
    for (int axis = 0; axis < 3; ++axis) {
      for (const double step : {-1e-3, 1e-3}) {
        Pose2 other = best;
        (axis == 0 ? other.x_m : axis == 1 ? other.y_m : other.theta_rad) += step;
        EXPECT_GE(cost(other), cost(best));
      }
    }
  }
}

TEST(EvaluateReference, TooFewCommonStampsAreAnError) {
  EXPECT_THROW(evaluate_reference({{0, {}}, {1, {}}}, {{0, {}}, {7, {}}}, {}), InputError);
  EXPECT_THROW(evaluate_reference({}, {}, {}), InputError);
}

// The public logs' own odometry against their verified relations: published figures, so this tests the metric, the
// matching of stamps and the readers together.
struct RawOdometry {
  const char* name;
  std::size_t relations;
  std::size_t loops;
  double translation_m;
  double rotation_deg;
  double tolerance_m;  // half a unit of the last published digit
  double tolerance_deg;
};

void PrintTo(const RawOdometry& log, std::ostream* out) { *out << log.name; }

class RawOdometryTest : public testing::TestWithParam<RawOdometry> {};

// Scores the odometry of a log, as a reader gives it, against relations.
RelationReport odometry_report(const std::string& log, const std::string& relations) {
  Trajectory trajectory;
  const auto reader = open_log(log, {});
  while (const auto record = reader->next()) {
    const auto* const scan = std::get_if<ScanRecord>(&*record);
    if (scan != nullptr) trajectory.push_back({scan->scan.stamp_s, scan->T_odom_base.value()});
  }
  return evaluate_relations(trajectory, read_relations(relations));
}

TEST_P(RawOdometryTest, ScoresThePublishedError) {
  const std::string stem = std::string("slam2d/") + GetParam().name;
  GDTSLAM_REAL_DATA(log, stem + ".clf.gz");
  GDTSLAM_REAL_DATA(relations, stem + ".relations.gz");
  const RelationReport report = odometry_report(log, relations);
  EXPECT_EQ(report.unmatched, 0u);
  EXPECT_EQ(report.all.translation_m.count, GetParam().relations);
  EXPECT_EQ(report.loops.translation_m.count, GetParam().loops);
  EXPECT_NEAR(report.all.translation_m.mean, GetParam().translation_m, GetParam().tolerance_m);
  EXPECT_NEAR(report.all.rotation_deg.mean, GetParam().rotation_deg, GetParam().tolerance_deg);
}

INSTANTIATE_TEST_SUITE_P(Logs, RawOdometryTest,
                         testing::Values(RawOdometry{"intel", 2984, 1212, 7.37, 39.0, 0.005, 0.5},
                                         RawOdometry{"fr079", 1685, 698, 6.50, 30.0, 0.005, 0.5},
                                         RawOdometry{"mit-csail", 1172, 126, 1.68, 5.1, 0.005, 0.05}),
                         [](const auto& log) {
                           return std::string(log.param.name == std::string("mit-csail") ? "csail" : log.param.name);
                         });

// The same on a log whose errors are known in closed form: a robot turns evenly on the spot, 3 degrees a second, while
// its odometry says 3.03; then it drives straight, 0.5 m a second, while its odometry says 0.51. Over t seconds the
// odometry is off by 0.03 t degrees in the first half and by 0.01 t metres in the second.
TEST(RawOdometrySimulated, ScoresTheErrorThatItsWheelsMake) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("gdtslam-odometry-{}", ::getpid());
  std::filesystem::create_directory(folder);
  const std::string log = (folder / "wheels.log").string();
  const std::string relations = (folder / "wheels.relations").string();
  {
    std::ofstream scans(log);
    for (int t = 0; t < 60; ++t) {
      const double heading = rad_from_deg(3.03 * std::min(t, 30));
      const double way = 0.51 * std::max(t - 30, 0);
      const std::string pose =
          fmt::format("{:.9f} {:.9f} {:.9f}", way * std::cos(heading), way * std::sin(heading), heading);
      scans << "FLASER 180";
      for (int beam = 0; beam < 180; ++beam) scans << " 1.0";
      scans << fmt::format(" {0} {0} {1}.000000 host {1}.000000\n", pose, t);
    }
    std::ofstream file(relations);
    for (int t = 0; t < 30; t += 2) {
      file << fmt::format("{} {} 0 0 0 0 0 {:.12f}\n", t, 30, rad_from_deg(3.0 * (30 - t)));
      file << fmt::format("{} {} {:.9f} 0 0 0 0 0\n", 30, 30 + t, 0.5 * t);
    }
  }
  const RelationReport report = odometry_report(log, relations);
  EXPECT_EQ(report.unmatched, 0U);
  EXPECT_EQ(report.all.translation_m.count, 30U);
  EXPECT_EQ(report.loops.translation_m.count, 5U + 4U);  // more than 20 s: turns of 30 to 22 s, ways of 22 to 28 s
  // 15 turns of 30, 28, ... 2 s and 15 ways of 0, 2, ... 28 s, in 30 relations.
  EXPECT_NEAR(report.all.rotation_deg.mean, 0.03 * (30 + 2) / 2 / 2, 1e-6);
  EXPECT_NEAR(report.all.translation_m.mean, 0.01 * 28 / 2 / 2, 1e-6);
  EXPECT_NEAR(report.all.translation_m.max, 0.01 * 28, 1e-6);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace gdtslam
