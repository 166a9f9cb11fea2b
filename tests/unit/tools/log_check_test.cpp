// Logs are made record by record, with faults whose number and size are known.
#include "engine/runs/streams/log_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "checked_log.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A straight drive of 0.1 m a scan at 5 Hz.
std::vector<LogRecord> drive(int scans) {
  std::vector<LogRecord> records;
  for (int k = 0; k < scans; ++k) records.emplace_back(driven_scan(10.0 + 0.2 * k, {0.1 * k, 0.0, 0.0}));
  return records;
}

TEST(LogCheck, CountsWhatIsThere) {
  std::vector<LogRecord> records = drive(51);
  records.emplace_back(Odometry{20.0, {}});
  records.emplace_back(Encoder{20.0, 7});
  records.emplace_back(Tilt{20.0, 0.1});
  const LogCheck check = checked_log(records);
  EXPECT_EQ(check.scans, 51u);
  EXPECT_EQ(check.scans_with_odometry, 51u);
  EXPECT_EQ(check.odometry_records, 1u);
  EXPECT_EQ(check.nod.encoder_records, 1u);
  EXPECT_EQ(check.nod.tilt_records, 1u);
  EXPECT_NEAR(check.duration_s(), 10.0, 1e-9);
  EXPECT_NEAR(check.median_step_s, 0.2, 1e-9);
  EXPECT_NEAR(check.path_m, 5.0, 1e-9);
  EXPECT_EQ(check.gaps.count + check.backward_stamps.count + check.repeated_stamps.count + check.impossible_steps.count,
            0u);
  EXPECT_EQ(check.obstacle(), "");
}

TEST(LogCheck, FindsTimeJumps) {
  std::vector<LogRecord> records = drive(20);
  std::get<ScanRecord>(records[5]).scan.stamp_s = std::get<ScanRecord>(records[4]).scan.stamp_s;         // repeated
  std::get<ScanRecord>(records[10]).scan.stamp_s = std::get<ScanRecord>(records[9]).scan.stamp_s - 0.4;  // backward
  for (std::size_t k = 15; k < 20; ++k) std::get<ScanRecord>(records[k]).scan.stamp_s += 7.0;            // gap
  const LogCheck check = checked_log(records);
  EXPECT_EQ(check.repeated_stamps.count, 1u);
  EXPECT_EQ(check.repeated_stamps.first[0].scan, 5u);
  EXPECT_EQ(check.backward_stamps.count, 1u);
  EXPECT_EQ(check.backward_stamps.first[0].scan, 10u);
  EXPECT_NEAR(check.backward_stamps.largest, 0.4, 1e-9);
  EXPECT_EQ(check.gaps.count, 1u);
  ASSERT_EQ(check.gaps.first.size(), 1u);
  EXPECT_EQ(check.gaps.first[0].scan, 15u);
  EXPECT_NEAR(check.gaps.largest, 7.2, 1e-9);
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("backward")));
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("gaps")));
}

TEST(LogCheck, StepsBeyondTheHistogramHaveTheirMedian) {
  const auto with_step = [](double step_s, int scans) {
    std::vector<LogRecord> records;
    for (int k = 0; k < scans; ++k) records.emplace_back(driven_scan(step_s * k, {}));
    return checked_log(records);
  };
  const LogCheck slow = with_step(30.0, 50);
  EXPECT_NEAR(slow.usual_step_s, 30.0, 1e-9);
  EXPECT_NEAR(with_step(0.2, 50).usual_step_s, 0.2, 1e-9);
  EXPECT_THAT(slow.suggestions(), Contains(HasSubstr("are they milliseconds?")));
  const LogCheck nanoseconds = with_step(1e8, 50);
  EXPECT_NEAR(nanoseconds.usual_step_s, 1e8, 1.0);
  EXPECT_THAT(nanoseconds.suggestions(), Contains(HasSubstr("are they nanoseconds?")));
  EXPECT_THAT(with_step(1e5, 50).suggestions(), Contains(HasSubstr("are they microseconds?")));
  EXPECT_THAT(with_step(10.0, 50).suggestions(), testing::Not(Contains(HasSubstr("are they"))));
}

TEST(LogCheck, RangesAndHeadingsOfAnotherUnitAreAskedAbout) {
  const auto asked = [](float metre, double radian, float no_return_m) {
    std::vector<LogRecord> records;
    for (int k = 0; k < 100; ++k) {
      const std::vector<float> ranges_m{(1.0F + 0.01F * static_cast<float>(k)) * metre,
                                        2.5F * metre,
                                        4.0F * metre,
                                        no_return_m,
                                        no_return_m,
                                        no_return_m,
                                        no_return_m};
      const double heading_rad = wrap_angle(0.15 * k);  // from -pi to pi again and again
      records.emplace_back(driven_scan(10.0 + 0.2 * k, {0.1 * k, 0.0, heading_rad * radian}, ranges_m));
    }
    return checked_log(records);
  };
  EXPECT_THAT(asked(1.0F, 1.0, 0.0F).questions_of_units, IsEmpty());
  EXPECT_THAT(asked(1.0F, 1.0, 9999.0F).questions_of_units, IsEmpty()) << "a constant that stands for no return";
  for (const float scale : {100.0F, 1000.0F}) {
    const LogCheck check = asked(scale, 1.0, 0.0F);
    EXPECT_THAT(check.questions_of_units, ElementsAre(HasSubstr("are they millimetres or centimetres?")));
    EXPECT_THAT(check.suggestions(), Contains(HasSubstr("millimetres")));
    EXPECT_THAT(check.ranges.no_return_m, IsEmpty());
  }
  EXPECT_THAT(asked(1.0F, 180.0 / kPi, 0.0F).questions_of_units, ElementsAre(HasSubstr("are they degrees?")));
}

TEST(LogCheck, FindsImpossibleStepsAndLeavesThemOutOfThePath) {
  std::vector<LogRecord> records = drive(21);
  for (std::size_t k = 10; k < 21; ++k) std::get<ScanRecord>(records[k]).T_odom_base->x_m += 5.0;  // one leap
  for (std::size_t k = 15; k < 21; ++k) {                                                          // one twist
    std::get<ScanRecord>(records[k]).T_odom_base->theta_rad = rad_from_deg(85.0);
  }
  const LogCheck check = checked_log(records);
  EXPECT_EQ(check.impossible_steps.count, 2u);
  EXPECT_EQ(check.impossible_steps.first[0].scan, 10u);
  EXPECT_NEAR(check.impossible_steps.first[0].distance_m, 5.1, 1e-9);
  EXPECT_EQ(check.impossible_steps.first[1].scan, 15u);
  EXPECT_NEAR(deg_from_rad(check.impossible_steps.first[1].angle_rad), 85.0, 1e-9);
  EXPECT_NEAR(check.path_m, 18 * 0.1, 1e-9);
}

TEST(LogCheck, OdometryRecordsServeWhereScansHaveNone) {
  std::vector<LogRecord> records;
  for (int k = 0; k < 11; ++k) {
    records.emplace_back(Odometry{0.2 * k, {0.3 * k, 0.0, 0.0}});
    ScanRecord scan = driven_scan(0.2 * k, {});
    scan.T_odom_base.reset();
    records.emplace_back(scan);
  }
  const LogCheck check = checked_log(records);
  EXPECT_EQ(check.scans_with_odometry, 0u);
  EXPECT_NEAR(check.path_m, 3.0, 1e-9);
  EXPECT_THAT(check.suggestions(), IsEmpty());
}

// A SICK reports 81.91 m where nothing comes back; the true ranges fill the histogram up to 30 m.
TEST(LogCheck, FindsTheNoReturnValue) {
  Random random(1);
  std::vector<LogRecord> records;
  for (int k = 0; k < 200; ++k) {
    std::vector<float> ranges_m;
    for (int beam = 0; beam < 180; ++beam) {
      ranges_m.push_back(random.uniform() < 0.03 ? 81.91F : static_cast<float>(random.uniform(0.5, 30.0)));
    }
    records.emplace_back(driven_scan(0.1 * k, {}, ranges_m));
  }
  const RangeStatistics ranges = checked_log(records).ranges;
  EXPECT_THAT(ranges.no_return_m, ElementsAre(testing::DoubleNear(81.91, 1e-9)));
  EXPECT_EQ(ranges.returns + ranges.no_return_count, 200u * 180u);
  EXPECT_NEAR(static_cast<double>(ranges.no_return_count), 0.03 * 200 * 180, 150.0);
  EXPECT_NEAR(ranges.median_m, 15.25, 0.5);
  EXPECT_LE(ranges.longest_m, 30.0);
  EXPECT_GE(ranges.shortest_m, 0.5);
}

TEST(LogCheck, MemoryIsBounded) {
  LogChecker checker{StepBounds{}};
  for (int k = 0; k < 5000; ++k) {
    ScanRecord scan = driven_scan(-static_cast<double>(k), {10.0 * k, 0.0, 0.0},
                                  std::vector<float>(static_cast<std::size_t>(k % 50)));
    checker.add(scan);
  }
  const LogCheck check = checker.finish({});
  EXPECT_EQ(check.backward_stamps.count, 4999u);
  EXPECT_EQ(check.backward_stamps.first.size(), EventList::kMostListed);
  EXPECT_EQ(check.impossible_steps.count, 4999u);
  EXPECT_LE(check.layouts.size(), 16u);
  std::uint64_t scans = check.other_layouts;
  for (const BeamLayout& layout : check.layouts) scans += layout.scans;
  EXPECT_EQ(scans, 5000u);
}

}  // namespace
}  // namespace gdtslam
