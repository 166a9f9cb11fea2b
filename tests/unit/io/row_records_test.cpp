// What rows of tables say, at the limits of docs/formats.md: bearings within a turn, lasers 0 to 63, ranges and points.
#include "engine/io/tables/row_records.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/tables/row_parser.hpp"
#include "gdtslam/core/angle.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

TableRow row_of_ranges(std::vector<double> ranges_m, double first_rad = -0.5, double step_rad = 0.25) {
  TableRow row;
  row[TableNumber::kStamp] = 1.0;
  row[TableNumber::kAngleMin] = first_rad;
  row[TableNumber::kAngleIncrement] = step_rad;
  row.has_ranges = true;
  row.ranges_m = std::move(ranges_m);
  return row;
}

struct RowOutcome {
  std::vector<LogRecord> records{};
  RangeRepairs repairs{};
  std::string refusal{};
  [[nodiscard]] const LaserScan& scan() const { return std::get<ScanRecord>(records.at(0)).scan; }
};
RowOutcome outcome_of(RowRecords& rows, TableRow row) {
  RowOutcome outcome;
  try {
    outcome.records = rows.records(row, outcome.repairs);
  } catch (const MalformedRow& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}
RowOutcome outcome_of(const TableRow& row, const ReadOptions& options = {}) {
  RowRecords rows(options);
  return outcome_of(rows, row);
}

TEST(RowRecords, BearingsLieWithinATurnAndStepsWithinHalfOfOne) {
  EXPECT_EQ(outcome_of(row_of_ranges({1.0, 2.0}, -kTwoPi, kPi)).refusal, "");
  EXPECT_EQ(outcome_of(row_of_ranges({1.0, 2.0}, kTwoPi, -kPi)).refusal, "");
  for (const auto& [first_rad, step_rad] : {std::pair(-6.2832, 0.1), {6.2832, 0.1}, {0.0, 3.1416}, {0.0, -3.1416}}) {
    EXPECT_THAT(outcome_of(row_of_ranges({1.0, 2.0}, first_rad, step_rad)).refusal,
                HasSubstr("beyond one turn: they are in radians"))
        << first_rad << ' ' << step_rad;
  }
  EXPECT_EQ(outcome_of(row_of_ranges({1.0, 2.0}, 0.0, 0.0)).refusal, "has an angle_increment of 0 for several ranges");
  EXPECT_EQ(outcome_of(row_of_ranges({1.0}, 0.0, 0.0)).refusal, "") << "one has no step";
}

TEST(RowRecords, WhatWasSaidOfTheSensorHoldsUntilAnotherRowSaysOtherwise) {
  RowRecords rows({});
  TableRow first = row_of_ranges({1.0, 2.0, 3.0});
  first[TableNumber::kRangeMax] = 20.0;
  first[TableNumber::kTimeIncrement] = 0.001;
  (void)outcome_of(rows, first);
  TableRow bare;
  bare[TableNumber::kStamp] = 2.0;
  bare.has_ranges = true;
  bare.ranges_m = {1.0, 2.0, 3.0};
  const LaserScan scan = outcome_of(rows, bare).scan();
  EXPECT_EQ(scan.first_bearing_rad, -0.5);
  EXPECT_EQ(scan.bearing_step_rad, 0.25);
  EXPECT_EQ(scan.max_range_m, 20.0);
  EXPECT_EQ(scan.beam_period_s, 0.001);
  TableRow with_last = bare;
  with_last[TableNumber::kAngleMax] = 1.5;
  EXPECT_EQ(outcome_of(rows, with_last).scan().bearing_step_rad, 1.0) << "in place of the increment";
  EXPECT_EQ(outcome_of(rows, bare).scan().bearing_step_rad, 1.0);
  EXPECT_THAT(outcome_of(bare).refusal, HasSubstr("neither it nor a row before it has angle_min"));
  bare.ranges_m.clear();
  EXPECT_EQ(outcome_of(bare).refusal, "") << "without ranges there is nothing to know";
}

TEST(RowRecords, LasersAreNumberedFrom0To63) {
  EXPECT_EQ(std::get<ScanRecord>(outcome_of(row_of_ranges({1.0})).records.at(0)).laser, 0U)
      << "where no row says which";
  for (const double laser : {0.0, 1.0, 63.0, 64.0, -1.0, 0.5, 62.5}) {
    TableRow row = row_of_ranges({1.0});
    row[TableNumber::kLaser] = laser;
    const RowOutcome outcome = outcome_of(row);
    if (laser >= 0.0 && laser <= 63.0 && laser == std::floor(laser)) {
      EXPECT_EQ(std::get<ScanRecord>(outcome.records.at(0)).laser, static_cast<std::size_t>(laser));
    } else {
      EXPECT_THAT(outcome.refusal, EndsWith("as its laser, which is no whole number from 0 to 63")) << laser;
    }
  }
}

TEST(RowRecords, ALimitIsAboveZeroAndFinite) {
  for (const auto& [stated_m, limit_m] :
       {std::pair(20.0, 20.0), {0.0, 0.0}, {-5.0, 0.0}, {std::numeric_limits<double>::infinity(), 0.0}}) {
    TableRow row = row_of_ranges({1.0});
    row[TableNumber::kRangeMax] = stated_m;
    EXPECT_EQ(outcome_of(row).scan().max_range_m, limit_m);
    EXPECT_EQ(outcome_of(row, {.max_range_m = 7.0}).scan().max_range_m, 7.0);
  }
}

TableRow json_row(const std::string& line) {
  TableRow row;
  parse_json_row(line, row, [](std::string_view, std::string_view) {});
  return row;
}

std::string json_refusal(const std::string& line) {
  return told_by<MalformedRow>([&] { (void)json_row(line); });
}

// What is skipped may be nested, and numbers may come in pairs, not deeper.
TEST(JsonRows, ArraysOfPairsAndTextsWithEscapes) {
  EXPECT_THAT(json_row("{\"stamp\":1,\"points\":[[1,2],[3,4]]}").points_m, ElementsAre(1.0, 2.0, 3.0, 4.0));
  EXPECT_THAT(json_row("{\"stamp\":1,\"points\":[]}").points_m, ElementsAre());
  EXPECT_EQ(json_row(R"({"name":"a\n\t\"\\\/b\u00e4c","value":""})").name, "a\n\t\"\\/b\u00e4c");
  EXPECT_EQ(json_row(R"({"stamp":1,"ticks":-9007199254740993})").ticks, -9007199254740993);
  EXPECT_THAT(json_refusal(R"({"ticks":1.5})"), HasSubstr("a whole number as its ticks"));
  EXPECT_THAT(json_refusal(R"({"ticks":1e3})"), HasSubstr("a whole number as its ticks"));
  EXPECT_THAT(json_refusal(R"({"name":"a\)"), HasSubstr("ends before its JSON is complete"));
  EXPECT_THAT(json_refusal(R"({"name":"a\u12)"), HasSubstr("ends before its JSON is complete"));
  EXPECT_EQ(json_refusal("{}"), "");
  EXPECT_TRUE(std::signbit(*json_row(R"({"x":-0})")[TableNumber::kX])) << "a sign is a bit of the pose";
  EXPECT_EQ(json_row(R"({"x":-0.5,"y":-Infinity})")[TableNumber::kX], -0.5);
  EXPECT_EQ(json_row(R"({"y":-Infinity})")[TableNumber::kY], -std::numeric_limits<double>::infinity());
}

TEST(ListedNumbers, StandBetweenBlanksCommasSemicolonsAndBrackets) {
  const auto numbers_in = [](const std::string& text) {
    std::vector<double> numbers;
    append_listed_numbers(text, "ranges", numbers);
    return numbers;
  };
  EXPECT_THAT(numbers_in("1 2,3;4\t5\r"), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0));
  EXPECT_THAT(numbers_in("[(1.5, -2)]"), ElementsAre(1.5, -2.0));
  EXPECT_THAT(numbers_in(""), ElementsAre());
  EXPECT_THAT(numbers_in(" none "), ElementsAre());
  EXPECT_THROW(numbers_in("1 none"), MalformedRow);
  EXPECT_THROW(numbers_in("1:2"), MalformedRow);
}

}  // namespace
}  // namespace gdtslam
