// What a stream of scans looks ahead for, hears behind the last wanted scan, and tells of its progress: records are
// given to it one by one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// Gives records; a Parameter named "fault" is one that cannot be read.
class ListedRecords : public LogReader {
 public:
  ListedRecords(std::vector<LogRecord> records, bool knows_progress)
      : records_(std::move(records)), knows_progress_(knows_progress) {}
  std::optional<LogRecord> next() override {
    if (given_ == records_.size()) return std::nullopt;
    const LogRecord& record = records_[given_++];
    if (const auto* parameter = std::get_if<Parameter>(&record); parameter && parameter->name == "fault") {
      throw InputError({"a", given_}, "cannot be read");
    }
    return record;
  }
  [[nodiscard]] double progress() const override {
    return knows_progress_ ? static_cast<double>(given_) / static_cast<double>(records_.size()) : -1.0;
  }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_; }

 private:
  std::vector<LogRecord> records_;
  bool knows_progress_;
  std::size_t given_ = 0;
  std::vector<Warning> warnings_;
};

ScanRecord listed_scan(double stamp_s) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.ranges_m = {1.0F, 2.0F};
  return record;
}

using Logs = std::vector<std::vector<LogRecord>>;

ScanStream stream_of(const Logs& logs, const ScanRange& range = {}, bool knows_progress = true,
                     const ReadOptions& options = {}) {
  return {std::vector<std::string>(logs.size(), "a"), options, range,
          [=](std::size_t log) { return std::make_unique<ListedRecords>(logs[log], knows_progress); }};
}

std::vector<double> stamps_of(ScanStream& stream) {
  std::vector<double> stamps_s;
  while (const std::optional<ScanRecord> scan = stream.next()) stamps_s.push_back(scan->scan.stamp_s);
  return stamps_s;
}

const LogRecord kFault = Parameter{"fault", ""};

TEST(ScanStreamRules, AMountIsLookedForSoManyScansAhead) {
  for (const LogRecord& message : {LogRecord(Encoder{2.5, 7}), LogRecord(Tilt{2.5, 0.1})}) {
    const Logs logs{
        {listed_scan(0.0), Parameter{"a", "b"}, listed_scan(1.0), listed_scan(2.0), message, listed_scan(3.0)}};
    const bool is_tilt = std::holds_alternative<Tilt>(message);
    ScanStream far_enough = stream_of(logs);
    EXPECT_EQ(far_enough.nod_kind(4), is_tilt ? NodKind::kTilt : NodKind::kEncoder);
    EXPECT_EQ(stamps_of(far_enough), (std::vector<double>{0.0, 1.0, 2.0, 3.0})) << "none is lost, none comes twice";
    ScanStream too_near = stream_of(logs);
    EXPECT_EQ(too_near.nod_kind(3), NodKind::kNone);
    EXPECT_EQ(stamps_of(too_near), (std::vector<double>{0.0, 1.0, 2.0, 3.0}));
  }
}

TEST(ScanStreamRules, MessagesThatNobodyTakesAreCounted) {
  const Logs logs{{Tilt{0.5, 0.1}, Odometry{0.6, {}}, listed_scan(1.0), Encoder{1.5, 7}, Parameter{"a", "b"}}};
  ScanStream unheard = stream_of(logs);
  EXPECT_EQ(stamps_of(unheard).size(), 1U);
  ASSERT_EQ(unheard.warnings().size(), 1U);
  EXPECT_EQ(unheard.warnings()[0].kind, "nodding message not used");
  EXPECT_EQ(unheard.warnings()[0].count, 2U);
  EXPECT_EQ(unheard.warnings()[0].first, "TILT at 0.5 s");
  ScanStream heard = stream_of(logs);
  std::size_t records = 0;
  heard.set_listener({[&](const LogRecord& record) {
                        ++records;
                        return !std::holds_alternative<Encoder>(record);
                      },
                      {}});
  EXPECT_EQ(stamps_of(heard).size(), 1U);
  EXPECT_EQ(records, 4U) << "all but the scan";
  ASSERT_EQ(heard.warnings().size(), 1U);
  EXPECT_EQ(heard.warnings()[0].count, 1U);
  EXPECT_EQ(heard.warnings()[0].first, "ENCODER at 1.5 s");
}

TEST(ScanStreamRules, BehindTheLastWantedScanTheListenerIsFed) {
  const Logs logs{{listed_scan(0.0), listed_scan(1.0), Encoder{1.5, 7}, listed_scan(2.0), Encoder{2.5, 8}, kFault,
                   Encoder{3.0, 9}}};
  ScanStream stream = stream_of(logs, {.count = 2});
  std::vector<double> heard_s;
  stream.set_listener({[&](const LogRecord& record) {
                         heard_s.push_back(std::get<Encoder>(record).stamp_s);
                         return true;
                       },
                       {}});
  EXPECT_TRUE(stream.next());
  EXPECT_FALSE(stream.feed_listener()) << "one more is wanted";
  EXPECT_TRUE(stream.next());
  EXPECT_FALSE(stream.next());
  EXPECT_TRUE(stream.feed_listener());
  EXPECT_TRUE(stream.feed_listener()) << "a scan, of which the listener hears nothing";
  EXPECT_TRUE(stream.feed_listener());
  EXPECT_EQ(heard_s, (std::vector<double>{1.5, 2.5}));
  EXPECT_FALSE(stream.feed_listener()) << "what cannot be read there is nobody's concern";
  ScanStream at_end = stream_of({{listed_scan(0.0)}}, {.count = 1});
  EXPECT_TRUE(at_end.next());
  EXPECT_FALSE(at_end.feed_listener());
}

TEST(ScanStreamRules, BeamsAreTimedAsStatedOrAllAtOnce) {
  ScanRecord logged = listed_scan(0.0);
  logged.scan.first_beam_after_s = 0.25;
  logged.scan.beam_period_s = 0.5;
  const auto times = [&](const ReadOptions& options) {
    ScanStream stream = stream_of({{logged}}, {}, true, options);
    const LaserScan scan = stream.next()->scan;
    return std::pair(scan.first_beam_after_s, scan.beam_period_s);
  };
  EXPECT_EQ(times({}), std::pair(0.25, 0.5));
  EXPECT_EQ(times({.first_beam_after_s = -0.5}), std::pair(-0.5, 0.5));
  EXPECT_EQ(times({.beam_period_s = -0.125}), std::pair(0.25, -0.125));
  EXPECT_EQ(times({.beam_period_s = -0.125, .deskew = false}), std::pair(0.0, 0.0));
}

// The odometry of a later log goes on where that of the one before ended, whatever its own frame; a log that has none
// leaves the place as it is.
TEST(ScanStreamRules, OdometryGoesOnBehindALogWithoutAny) {
  const auto driven = [](double stamp_s, const Pose2& T_odom_base) {
    ScanRecord record = listed_scan(stamp_s);
    record.T_odom_base = T_odom_base;
    return LogRecord(record);
  };
  ScanStream stream = stream_of({{driven(0.0, {1.0, 2.0, 0.5})},
                                 {listed_scan(1.0)},
                                 {driven(2.0, {7.0, 0.0, 1.0}), driven(3.0, {7.0, 0.0, 1.25})}});
  EXPECT_TRUE(*stream.next()->T_odom_base == (Pose2{1.0, 2.0, 0.5}));
  EXPECT_FALSE(stream.next()->T_odom_base);
  const Pose2 third = *stream.next()->T_odom_base;
  EXPECT_NEAR(third.x_m, 1.0, 1e-12);
  EXPECT_NEAR(third.y_m, 2.0, 1e-12);
  EXPECT_NEAR(third.theta_rad, 0.5, 1e-12);
  EXPECT_NEAR(stream.next()->T_odom_base->theta_rad, 0.75, 1e-12);
  ScanStream begins = stream_of({{listed_scan(0.0)}, {driven(1.0, {7.0, 0.0, 1.0})}});
  EXPECT_FALSE(begins.next()->T_odom_base);
  EXPECT_TRUE(*begins.next()->T_odom_base == (Pose2{7.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace gdtslam
