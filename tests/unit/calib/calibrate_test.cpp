// What calibrate refuses, at the limits that calibration.hpp states, and what it says of ranges that are exact: they
// are made by (A1), r = d / cos(elevation), from a linkage whose lengths, zero and assembly the test knows.
#include "gdtslam/calib/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kExactWall_m = 2.0;

const SweepModel kTruth = sweep_model_of_preset("paper-b");

std::vector<CalibrationSurface> exact_wall() { return {{.name = "wall", .distance_m = kExactWall_m}}; }

// Exact ranges to the wall from 200 stops of the crank where the elevation is within the limits.
std::vector<RangeObservation> exact_ranges(double from_rad = -1.4, double to_rad = 1.4, double sigma_m = 0.001) {
  std::vector<RangeObservation> seen;
  for (int stop = 0; stop < 200; ++stop) {
    const double ticks = static_cast<double>(kTruth.encoder.ticks_per_turn) * stop / 200.0;
    const double elevation = *elevation_rad(kTruth, crank_rad(kTruth.encoder, ticks));
    if (elevation < from_rad || elevation > to_rad) continue;
    seen.push_back({.ticks = ticks, .range_m = kExactWall_m / std::cos(elevation), .sigma_m = sigma_m});
  }
  return seen;
}

template <typename Error>
std::string refusal(const SweepModel& start, const std::vector<CalibrationSurface>& surfaces,
                    const std::vector<RangeObservation>& seen, const CalibrationOptions& options = {}) {
  try {
    calibrate(start, surfaces, seen, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// Ten degrees of elevation are needed: nine are refused, eleven are taken.
TEST(Calibrate, RefusesASweepOfLessThanTenDegrees) {
  const auto within = [](double degrees) {
    std::vector<RangeObservation> seen;
    for (const RangeObservation& one : exact_ranges(0.0, rad_from_deg(degrees))) {
      for (int k = 0; k < 4; ++k) seen.push_back(one);
    }
    return seen;
  };
  EXPECT_THAT(refusal<InputError>(kTruth, exact_wall(), within(9.0)), HasSubstr("a whole turn of the crank"));
  EXPECT_EQ(refusal<InputError>(kTruth, exact_wall(), within(11.5)), "no error");
}

TEST(Calibrate, RefusesFewerThanTwoRangesForEachParameter) {
  std::vector<RangeObservation> seen;
  const std::vector<RangeObservation> all = exact_ranges(-1.0, 1.0);
  for (std::size_t k = 0; k < 14; ++k) seen.push_back(all[k * (all.size() / 14)]);
  EXPECT_EQ(refusal<InputError>(kTruth, exact_wall(), seen), "no error") << "4 bars, zero, offset, distance: 14 for 7";
  seen.pop_back();
  EXPECT_THAT(refusal<InputError>(kTruth, exact_wall(), seen),
              AllOf(HasSubstr("13 of 13 ranges"), HasSubstr("7 parameters"), HasSubstr("at least 14")));
}

TEST(Calibrate, ExactRangesLeaveTheTruthAsItIs) {
  const CalibrationResult result = calibrate(kTruth, exact_wall(), exact_ranges(), {});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.outliers, 0U);
  EXPECT_LT(result.all_rms, 1e-3);
  EXPECT_LT(result.residual_rms, 1e-3);
  EXPECT_GT(result.other_assembly_rms, 1.0) << "the other assembly does not fit";
  for (const CalibratedParameter& parameter : result.parameters) {
    EXPECT_NEAR(parameter.estimate, parameter.start, 1e-6) << parameter.name;
    EXPECT_FALSE(parameter.at_bound) << parameter.name;
  }
  EXPECT_THAT(result.remarks, Contains(HasSubstr("one wall tells")));
  EXPECT_THAT(result.remarks, Not(Contains(HasSubstr("on its bound"))));
  EXPECT_THAT(result.remarks, Not(Contains(HasSubstr("scatter"))));
  EXPECT_THAT(result.remarks, Not(Contains(HasSubstr("do not fit"))));
}

TEST(Calibrate, FindsTheAssemblyThatWasStatedWrongly) {
  SweepModel start = kTruth;
  start.assembly = kTruth.assembly == Assembly::kOpen ? Assembly::kCrossed : Assembly::kOpen;
  start.elevation_sign = -kTruth.elevation_sign;
  const CalibrationResult result = calibrate(start, exact_wall(), exact_ranges(), {});
  EXPECT_EQ(result.model.assembly, kTruth.assembly);
  EXPECT_EQ(result.model.elevation_sign, kTruth.elevation_sign);
  EXPECT_LT(result.all_rms, 0.1);
  CalibrationOptions stays;
  stays.try_both_assemblies = false;
  EXPECT_EQ(calibrate(start, exact_wall(), exact_ranges(), stays).model.assembly, start.assembly);
}

// Whatever step it is at; who is asked only at the end would let it go on for a minute.
TEST(Calibrate, EndsWhereItIsAskedTo) {
  SweepModel start = kTruth;
  start.bars.crank_m += 0.002;
  int asked = 0;
  CalibrationOptions options;
  options.stop = [&asked] {
    ++asked;
    return false;
  };
  EXPECT_EQ(refusal<Error>(start, exact_wall(), exact_ranges(), options), "no error");
  const int steps = asked;
  EXPECT_GT(steps, 10);
  for (const int after : {0, 1, steps / 2, steps - 1}) {
    asked = 0;
    options.stop = [&asked, after] { return ++asked > after; };
    EXPECT_THAT(refusal<Error>(start, exact_wall(), exact_ranges(), options), HasSubstr("interrupted")) << after;
    EXPECT_LE(asked, after + 2);
  }
}

TEST(Calibrate, FindsAZeroThatIsNotKnown) {
  for (const double off : {2.0, -2.5}) {
    SweepModel start = kTruth;
    start.encoder.zero_rad = wrap_angle(kTruth.encoder.zero_rad + off);
    CalibrationOptions options;
    options.search_zero = true;
    const CalibrationResult result = calibrate(start, exact_wall(), exact_ranges(), options);
    EXPECT_LT(result.all_rms, 0.1) << off;
    for (int stop = 0; stop < 200; stop += 7) {
      const double ticks = static_cast<double>(kTruth.encoder.ticks_per_turn) * stop / 200.0;
      const double right = *elevation_rad(kTruth, crank_rad(kTruth.encoder, ticks));
      if (std::fabs(right) > 1.0) continue;
      EXPECT_NEAR(*elevation_rad(result.model, crank_rad(result.model.encoder, ticks)), right, 2e-4) << off;
    }
  }
}

// A zero near a whole turn that has to go on past it is one that a linkage file may have.
TEST(Calibrate, TellsTheZeroWithinATurn) {
  for (const double turn : {1.0, -1.0}) {
    SweepModel start = kTruth;
    start.encoder.zero_rad = turn * (kTwoPi - 0.01);
    std::vector<RangeObservation> seen = exact_ranges();
    const double zero = turn * (kTwoPi + 0.02);  // where the ticks of these ranges begin then
    const double per_tick = kTwoPi / static_cast<double>(kTruth.encoder.ticks_per_turn);
    for (RangeObservation& one : seen) {
      one.ticks -= (zero - kTruth.encoder.zero_rad) / (kTruth.encoder.direction * per_tick);
    }
    const CalibrationResult result = calibrate(start, exact_wall(), seen, {});
    EXPECT_LT(result.all_rms, 0.5);
    EXPECT_NEAR(wrap_angle(result.model.encoder.zero_rad - zero), 0.0, 0.005);
    EXPECT_TRUE(validate(result.model).empty()) << result.model.encoder.zero_rad;
  }
}

/// What a remark that begins so would have the parameters read: "name value unit, ..." of its end; metres, radians.
std::map<std::string, double> shifts_in(const std::vector<std::string>& remarks, const std::string& beginning) {
  std::map<std::string, double> shifts;
  for (const std::string& remark : remarks) {
    if (!remark.starts_with(beginning)) continue;
    const std::string words = remark.substr(remark.find("read as ") + 8);
    for (std::size_t begin = 0; begin < words.size();) {
      const std::size_t end = std::min(words.find(", ", begin), words.size());
      const std::string one = words.substr(begin, end - begin);
      const std::size_t number = one.find(' ') + 1;
      const double unit = one.ends_with(" mm") ? 0.001 : rad_from_deg(1.0);
      shifts[one.substr(0, number - 1)] = unit * std::stod(one.substr(number));
      begin = end + 2;
    }
  }
  return shifts;
}

// The oracle is the fit itself, of ranges that have what the remark supposes: by so much it moves the parameters.
TEST(Calibrate, SaysWhatABiasAndALeaningWallWouldBeReadAs) {
  const CalibrationOptions options{.huber_sigmas = 10.0};
  const CalibrationResult exact = calibrate(kTruth, exact_wall(), exact_ranges(-1.0, 1.0), options);
  const auto expect_moved = [&](const std::string& beginning, const std::vector<RangeObservation>& seen,
                                const std::string& most_moved) {
    const CalibrationResult moved = calibrate(kTruth, exact_wall(), seen, options);
    const std::map<std::string, double> told = shifts_in(exact.remarks, beginning);
    ASSERT_TRUE(told.contains(most_moved)) << beginning;
    for (std::size_t k = 0; k < exact.parameters.size(); ++k) {
      const auto shift = told.find(exact.parameters[k].name);
      if (shift == told.end()) continue;
      const double by = moved.parameters[k].estimate - exact.parameters[k].estimate;
      EXPECT_NEAR(shift->second, by, 0.06 * std::fabs(by)) << exact.parameters[k].name << ", told in two digits";
    }
  };
  std::vector<RangeObservation> longer = exact_ranges(-1.0, 1.0);
  for (RangeObservation& one : longer) one.range_m += 0.001;
  expect_moved("a bias of the ranges of 1 mm", longer, "distance.wall");
  std::vector<RangeObservation> leaning = exact_ranges(-1.0, 1.0);
  for (RangeObservation& one : leaning) {
    const double elevation = *elevation_rad(kTruth, crank_rad(kTruth.encoder, one.ticks));
    one.range_m = kExactWall_m / std::cos(elevation - rad_from_deg(0.1));
  }
  expect_moved("wall leaning by 0.1 deg", leaning, "offset");
}

}  // namespace
}  // namespace gdtslam::calib
