// Crank-rockers against published figures: the table of the paper's readings and a textbook's example.
#include "gdtslam/calib/crank_rocker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// The figures as printed, with as many digits.
struct Printed {
  const char* preset;
  double extremes_cm;
  double middles_cm;
  int sum_digits;
  double swing_deg;
  double time_ratio;
  double transmission_deg;
};

class PaperPresets : public testing::TestWithParam<Printed> {};

TEST_P(PaperPresets, HaveThePrintedFigures) {
  const Printed& printed = GetParam();
  const FourBar& bars = linkage_preset(printed.preset).bars;
  const GrashofInequality sums = grashof_inequality(bars);
  const double half_digit = 0.5 * std::pow(10.0, -printed.sum_digits) + 1e-9;
  EXPECT_NEAR(100.0 * sums.extremes_m, printed.extremes_cm, half_digit);
  EXPECT_NEAR(100.0 * sums.middles_m, printed.middles_cm, half_digit);
  for (const Assembly assembly : {Assembly::kOpen, Assembly::kCrossed}) {
    const CrankRockerReport report = analyse(bars, assembly);
    EXPECT_NEAR(deg_from_rad(report.swing_rad), printed.swing_deg, 0.0501);
    EXPECT_NEAR(report.time_ratio, printed.time_ratio, 0.01);  // some are printed cut, not rounded: 1.105, 1.0760
    EXPECT_NEAR(deg_from_rad(report.least_transmission_rad), printed.transmission_deg, 0.0501);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, PaperPresets,
                         testing::Values(Printed{"paper-a", 16.1, 17.3, 1, 49.0, 1.10, 42.9},
                                         Printed{"paper-a-calibrated", 15.66, 17.47, 2, 47.2, 1.03, 52.7},
                                         Printed{"paper-b", 12.4, 13.5, 1, 93.0, 2.85, 9.1},
                                         Printed{"paper-b-calibrated", 12.24, 13.78, 2, 89.7, 2.53, 10.4},
                                         Printed{"paper-c", 12.4, 13.5, 1, 93.0, 1.07, 34.3},
                                         Printed{"paper-c-calibrated", 12.24, 13.78, 2, 89.7, 1.14, 32.2}),
                         [](const auto& row) {
                           std::string name = row.param.preset;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(CrankRocker, LargestRatesOfTheReadings) {
  EXPECT_NEAR(analyse(linkage_preset("paper-a").bars, Assembly::kOpen).most_rocker_rate, 0.45, 0.005);
  EXPECT_NEAR(analyse(linkage_preset("paper-b").bars, Assembly::kOpen).most_rocker_rate, 2.59, 0.0051);
  EXPECT_NEAR(analyse(linkage_preset("paper-c").bars, Assembly::kOpen).most_rocker_rate, 1.07, 0.005);
}

TEST(CrankRocker, LiftIsTheSlowStroke) {
  const CrankRockerReport report = analyse(linkage_preset("paper-b").bars, Assembly::kOpen);
  EXPECT_NEAR(360.0 * report.lift_share, 266.0, 0.5);
  // Half a degree into the lift the rocker is above its lowest place and below its highest, in both directions.
  const double before = report.lowest.crank_rad + report.lift_direction * 0.01;
  const auto pose = solve(linkage_preset("paper-b").bars, Assembly::kOpen, before);
  ASSERT_TRUE(pose.has_value());
  EXPECT_GT(pose->rocker_rad, report.lowest.rocker_rad);
  const auto rates = motion(linkage_preset("paper-b").bars, Assembly::kOpen,
                            report.lowest.crank_rad + report.lift_direction * 2.0, report.lift_direction);
  ASSERT_TRUE(rates.has_value());
  EXPECT_GT(rates->rocker_rate, 0.0);
}

TEST(CrankRocker, ModesAreMirrorImages) {
  const FourBar& bars = linkage_preset("paper-b").bars;
  const CrankRockerReport open = analyse(bars, Assembly::kOpen);
  const CrankRockerReport crossed = analyse(bars, Assembly::kCrossed);
  EXPECT_DOUBLE_EQ(open.lowest.rocker_rad, -crossed.highest.rocker_rad);
  EXPECT_DOUBLE_EQ(open.highest.crank_rad, -crossed.lowest.crank_rad);
  EXPECT_EQ(open.lift_direction, crossed.lift_direction);
}

// Crank 2, coupler 4, rocker 3.5, ground 5: a published exercise, rocker swing about 69.8 deg.
TEST(CrankRocker, PublishedExample) {
  const CrankRockerReport report = analyse({2.0, 4.0, 3.5, 5.0}, Assembly::kOpen);
  EXPECT_NEAR(deg_from_rad(report.swing_rad), 69.8, 0.06);
}

TEST(CrankRocker, EqualStrokesOfACentricLinkage) {
  // a^2 + g^2 = b^2 + c^2 is the centric crank-rocker.
  const CrankRockerReport report = analyse({3.0, 7.0, 5.0, std::sqrt(65.0)}, Assembly::kOpen);
  EXPECT_NEAR(report.time_ratio, 1.0, 1e-12);
  EXPECT_EQ(report.lift_direction, 1);
  EXPECT_NEAR(std::sin(0.5 * report.swing_rad), 3.0 / 5.0, 1e-12);
}

std::string message_of(const FourBar& bars) {
  try {
    analyse(bars, Assembly::kOpen);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CrankRocker, SaysWhyALinkageIsNone) {
  EXPECT_THAT(message_of({0.02, 0.04, 0.035, 0.2}), HasSubstr("20 > 2 + 4 + 3.5 = 9.5 cm"));
  EXPECT_THAT(message_of({0.02, 0.04, 0.035, 0.06}), HasSubstr("shortest + longest > the other two, 8 > 7.5 cm"));
  EXPECT_THAT(message_of({0.02, 0.04, 0.03, 0.05}), HasSubstr("shortest + longest = the other two, 7 = 7 cm"));
  EXPECT_THAT(message_of({0.04, 0.035, 0.05, 0.02}), HasSubstr("double crank"));
  EXPECT_THAT(message_of({0.04, 0.035, 0.05, 0.02}), HasSubstr("the crank, 4 cm, must be the shortest bar"));
}

TEST(CrankRocker, RemarksOnWhatADesignerShouldKnow) {
  EXPECT_THAT(remarks(linkage_preset("paper-a").bars, Assembly::kOpen), IsEmpty());
  EXPECT_THAT(remarks(linkage_preset("paper-b").bars, Assembly::kOpen),
              Contains(testing::AllOf(HasSubstr("falls to 9.1 deg, below 40 deg"), HasSubstr("force"),
                                      HasSubstr("6.3 times as far"), HasSubstr("rattles"))));
  EXPECT_THAT(remarks(linkage_preset("paper-b").bars, Assembly::kOpen), Contains(HasSubstr("2.59 times as fast")));
  EXPECT_THAT(remarks({0.02, 0.04, 0.031, 0.05}, Assembly::kOpen),
              Contains(testing::AllOf(HasSubstr("next to a change point"), HasSubstr("7 < 7.1 cm, 0.1 cm apart"))));
}

// Two hundredths of all bars: 0.27 of 14.27 cm are less, 0.3 of 14.3 cm are more.
TEST(CrankRocker, IsNextToAChangePointByTwoHundredthsOfItsBars) {
  const auto is_near = Contains(HasSubstr("next to a change point"));
  EXPECT_THAT(remarks({0.02, 0.04, 0.0327, 0.05}, Assembly::kOpen), is_near);
  EXPECT_THAT(remarks({0.02, 0.04, 0.033, 0.05}, Assembly::kOpen), testing::Not(is_near));
}

TEST(CrankRocker, PresetsByName) {
  std::set<std::string_view> names;
  for (const LinkagePreset& preset : linkage_presets()) {
    EXPECT_TRUE(names.insert(preset.name).second);
    EXPECT_EQ(&linkage_preset(preset.name), &preset);
    EXPECT_EQ(grashof_class(preset.bars), GrashofClass::kCrankRocker);
  }
  EXPECT_EQ(names.size(), 6U);
  EXPECT_EQ(names.count(kDefaultLinkage), 1U);
  EXPECT_EQ(linkage_preset("paper-b").bars.crank_m, 0.036);
  EXPECT_EQ(linkage_preset("paper-b-calibrated").bars.ground_m, 0.0507);
  try {
    linkage_preset("paper-d");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("'paper-d'"), HasSubstr("paper-b-calibrated")));
  }
}

}  // namespace
}  // namespace gdtslam::calib
