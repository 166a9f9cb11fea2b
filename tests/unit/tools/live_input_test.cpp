// Parts between a sender and the mapper: whole lines, and the queue that drops what is too old.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/live/input/scan_queue.hpp"
#include "tools/gdtslam/live/input/whole_lines.hpp"

namespace gdtslam {
namespace {

std::string taken(WholeLines& lines, std::size_t most) {
  std::string text(most, '?');
  text.resize(lines.take(text));
  return text;
}

TEST(WholeLines, GivesNoPartOfALine) {
  WholeLines lines;
  lines.add("FLASER 1");
  EXPECT_TRUE(lines.is_empty());
  lines.add("80\nODOM 1\nOD");
  EXPECT_EQ(taken(lines, 5), "FLASE");
  EXPECT_EQ(taken(lines, 100), "R 180\nODOM 1\n");
  EXPECT_TRUE(lines.is_empty());
  EXPECT_EQ(taken(lines, 100), "");
  lines.add("OM 2\n");
  EXPECT_EQ(taken(lines, 100), "ODOM 2\n");
}

TEST(WholeLines, DropsWhatASenderLeftBehind) {
  WholeLines lines;
  lines.add("ODOM 1\nODO");
  EXPECT_TRUE(lines.drop_rest());
  EXPECT_FALSE(lines.drop_rest());
  lines.add("ODOM 2\n");
  EXPECT_EQ(taken(lines, 100), "ODOM 1\nODOM 2\n");
  EXPECT_FALSE(lines.drop_rest());
}

/// Records that are there at once, an end that waits until it is told to come, or something that cannot be read.
class ListedLog final : public LogReader {
 public:
  ListedLog(std::vector<LogRecord> records, std::shared_ptr<std::atomic<bool>> may_end, bool breaks_off)
      : records_(std::move(records)), may_end_(std::move(may_end)), breaks_off_(breaks_off) {}
  std::optional<LogRecord> next() override {
    if (given_ < records_.size()) return records_[given_++];
    while (!*may_end_) std::this_thread::yield();
    if (breaks_off_) throw InputError({"log", 7}, "is no line");
    return std::nullopt;
  }
  [[nodiscard]] double progress() const override { return -1.0; }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_; }

 private:
  std::vector<LogRecord> records_;
  std::shared_ptr<std::atomic<bool>> may_end_;
  bool breaks_off_;
  std::size_t given_ = 0;
  std::vector<Warning> warnings_;
};

ScanRecord queued_scan(double stamp_s, bool has_odometry) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  if (has_odometry) record.T_odom_base = Pose2{stamp_s, 0.0, 0.0};
  return record;
}

Odometry odometry_at(double stamp_s) { return {stamp_s, Pose2{stamp_s, 0.0, 0.0}}; }

/// "s1 o2 s3": what comes out, once all has been read ahead.
std::string through_queue(std::vector<LogRecord> records, std::size_t most_scans, std::uint64_t* dropped = nullptr) {
  const auto may_end = std::make_shared<std::atomic<bool>>(true);
  ScanQueue queue(
      std::make_unique<ListedLog>(std::move(records), may_end, false), most_scans, [] { return false; }, [] {});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  std::string text;
  while (const std::optional<LogRecord> record = queue.next()) {
    const bool is_scan = std::holds_alternative<ScanRecord>(*record);
    const double stamp_s = is_scan ? std::get<ScanRecord>(*record).scan.stamp_s : std::get<Odometry>(*record).stamp_s;
    text += (text.empty() ? "" : " ") + std::string(is_scan ? "s" : "o") + std::to_string(static_cast<int>(stamp_s));
  }
  if (dropped != nullptr) *dropped = queue.warnings().empty() ? 0 : queue.warnings().front().count;
  return text;
}

TEST(ScanQueue, DropsNothingWhileThereIsRoom) {
  std::uint64_t dropped = 1;
  EXPECT_EQ(through_queue({odometry_at(1), queued_scan(2, false), odometry_at(3), odometry_at(4), queued_scan(5, true)},
                          2, &dropped),
            "o1 s2 o3 o4 s5");
  EXPECT_EQ(dropped, 0U);
}

TEST(ScanQueue, DropsTheOldestScansAndKeepsTheirOdometry) {
  std::uint64_t dropped = 0;
  std::vector<LogRecord> with_own;
  for (int k = 1; k <= 6; ++k) with_own.emplace_back(queued_scan(k, true));
  EXPECT_EQ(through_queue(with_own, 2, &dropped), "o1 o2 o3 o4 s5 s6");
  EXPECT_EQ(dropped, 4U);
}

TEST(ScanQueue, GivesWhatCameBeforeALineThatIsNone) {
  const auto may_end = std::make_shared<std::atomic<bool>>(true);
  ScanQueue queue(
      std::make_unique<ListedLog>(std::vector<LogRecord>{queued_scan(1, true)}, may_end, true), 5, [] { return false; },
      [] {});
  EXPECT_TRUE(queue.next().has_value());
  EXPECT_THROW(queue.next(), InputError);
}

TEST(ScanQueue, EndsWithItsCallerWhoeverIsWaiting) {
  const auto may_end = std::make_shared<std::atomic<bool>>(false);
  std::atomic<bool> is_stopped = false;
  ScanQueue queue(
      std::make_unique<ListedLog>(std::vector<LogRecord>{}, may_end, false), 5, [&] { return is_stopped.load(); },
      [may_end] { *may_end = true; });
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    is_stopped = true;
  });
  EXPECT_FALSE(queue.next().has_value());
  stopper.join();
}

}  // namespace
}  // namespace gdtslam
