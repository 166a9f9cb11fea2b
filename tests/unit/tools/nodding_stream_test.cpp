// Scans wait for what tells where the crank was, no longer than they must, and come in log order.
#include "engine/runs/streams/nodding_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kTicksPerSecond = 5000.0;

/// A log of lines, and what a NoddingStream makes of it. The crank turns a quarter a second, from tick 0 at time 0.
class NoddingStreamOfLines : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string scan(double stamp_s) { return fmt_line("FLASER 3 1.0 2.0 3.0 0 0 0 0 0 0", stamp_s); }
  static std::string encoder(double stamp_s, double shift_s = 0.0) {
    return fmt_line("ENCODER " + std::to_string(std::llround(kTicksPerSecond * (stamp_s + shift_s)) % 20000), stamp_s);
  }
  static std::string fmt_line(const std::string& head, double stamp_s) {
    return head + " " + std::to_string(stamp_s) + " robot 0\n";
  }

  std::string write(const std::string& name, const std::vector<std::string>& lines) {
    const std::string path = (folder_ / name).string();
    std::ofstream file(path);
    for (const std::string& line : lines) file << line;
    return path;
  }

  struct Outcome {
    std::vector<double> stamps_s;
    std::vector<double> turns;  ///< at the stamp; -1 where nothing is known
    std::vector<LogReader::Warning> warnings;
    [[nodiscard]] std::uint64_t count_of(const std::string& kind) const {
      for (const LogReader::Warning& warning : warnings) {
        if (warning.kind == kind) return warning.count;
      }
      return 0;
    }
  };

  static Outcome read(const std::vector<std::string>& paths, const ScanRange& range = {},
                      NodKind kind = NodKind::kEncoder) {
    calib::SweepModel model = calib::sweep_model_of_preset("paper-b");
    model.mirror_rate_hz = 0.0;
    ScanStream scans(paths, {}, range);
    NoddingStream stream(scans, kind, model, {});
    Outcome outcome;
    while (const std::optional<NoddingScan> found = stream.next()) {
      outcome.stamps_s.push_back(found->record.scan.stamp_s);
      outcome.turns.push_back(found->knots.empty() ? -1.0
                                                   : static_cast<double>(found->knots.front().phase) / 4294967296.0);
    }
    outcome.warnings = stream.warnings();
    for (LogReader::Warning& warning : scans.warnings()) outcome.warnings.push_back(warning);
    return outcome;
  }
  Outcome read_lines(const std::vector<std::string>& lines) { return read(std::vector{write("a.log", lines)}, {}); }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("nodding_stream_test_" + std::to_string(::getpid()));
};

constexpr const char* kUncovered = "scans without the crank's position";
constexpr const char* kPast = "nodding stamp in the past";

TEST_F(NoddingStreamOfLines, AScanHasThePositionBetweenTheMessagesAroundIt) {
  const Outcome outcome = read_lines({encoder(1.0), scan(1.03), encoder(1.1), scan(1.1), encoder(1.2)});
  EXPECT_THAT(outcome.stamps_s, ElementsAre(1.03, 1.1));
  ASSERT_EQ(outcome.turns.size(), 2U);
  EXPECT_NEAR(outcome.turns[0], 0.25 * 1.03, 1e-4);
  EXPECT_NEAR(outcome.turns[1], 0.25 * 1.1, 1e-4);
  EXPECT_THAT(outcome.warnings, IsEmpty());
}

// Beams that the log says were measured from the stamp on, over a tenth of a second, one way or the other: the crank is
// known from the first of them to the last, in the order of time.
TEST_F(NoddingStreamOfLines, BeamsAreMeasuredWhenTheLogSays) {
  for (const bool is_clockwise : {false, true}) {
    std::string log;
    for (const double stamp_s : {1.0, 1.05, 1.1, 1.15, 1.2}) {
      log += "{\"stamp\":" + std::to_string(stamp_s) +
             ",\"ticks\":" + std::to_string(std::llround(kTicksPerSecond * stamp_s)) + "}\n";
    }
    log += std::string("{\"stamp\":1.03,\"angle_min\":0.1,\"angle_increment\":") + (is_clockwise ? "-0.1" : "0.1") +
           ",\"time_increment\":0.05,\"ranges\":[1,2,3]}\n";
    ScanStream scans({write("beams.jsonl", {log})}, {}, {});
    const calib::SweepModel model = calib::sweep_model_of_preset("paper-b");
    NoddingStream stream(scans, NodKind::kEncoder, model, {});
    const std::optional<NoddingScan> found = stream.next();
    ASSERT_TRUE(found);
    ASSERT_GE(found->knots.size(), 2U);
    EXPECT_NEAR(found->knots.front().offset_s, 0.0, 1e-9);
    EXPECT_NEAR(found->knots.back().offset_s, 0.1, 1e-9);
    const LaserScan& laser = found->record.scan;
    EXPECT_EQ(laser.ranges_m, (std::vector<float>{1.0F, 2.0F, 3.0F}));
    EXPECT_NEAR(laser.first_bearing_rad, 0.1, 1e-12);
    EXPECT_NEAR(laser.bearing_step_rad, is_clockwise ? -0.1 : 0.1, 1e-12);
    EXPECT_NEAR(calib::beam_timing(model, laser).of_beam_s(2), 0.1, 1e-12);
  }
}

TEST_F(NoddingStreamOfLines, ScansBeforeTheFirstAndAfterTheLastMessageAreNotCovered) {
  const Outcome outcome = read_lines({scan(0.9), encoder(1.0), scan(1.05), encoder(1.1), scan(1.15)});
  EXPECT_THAT(outcome.turns, ElementsAre(-1.0, testing::Gt(0.0), -1.0));
  EXPECT_EQ(outcome.count_of(kUncovered), 2U);
  EXPECT_EQ(outcome.warnings.front().first, "scan 0 at 0.900000 s");
}

TEST_F(NoddingStreamOfLines, MessagesUpToASecondLateAreWaitedFor) {
  std::vector<std::string> lines;
  for (int k = 0; k < 40; ++k) {
    lines.push_back(scan(1.0 + 0.1 * k));
    if (k >= 9) lines.push_back(encoder(1.0 + 0.1 * (k - 9)));
  }
  for (int k = 31; k < 41; ++k) lines.push_back(encoder(1.0 + 0.1 * k));
  const Outcome outcome = read_lines(lines);
  EXPECT_EQ(outcome.turns.size(), 40U);
  EXPECT_EQ(outcome.count_of(kUncovered), 0U);
}

// Two seconds late: what is a second older than the newest scan has gone without.
TEST_F(NoddingStreamOfLines, LaterOnesAreNot) {
  std::vector<std::string> lines;
  for (int k = 0; k < 40; ++k) {
    lines.push_back(scan(1.0 + 0.1 * k));
    if (k >= 20) lines.push_back(encoder(1.0 + 0.1 * (k - 20)));
  }
  const Outcome outcome = read_lines(lines);
  EXPECT_EQ(outcome.turns.size(), 40U);
  EXPECT_EQ(outcome.count_of(kUncovered), 40U);
}

// The second log begins again at time 1 with the counter elsewhere.
TEST_F(NoddingStreamOfLines, EachLogHasAClockOfItsOwn) {
  const std::string a = write("a.log", {encoder(1.0), scan(1.05), encoder(1.1), scan(1.15)});
  const std::string b = write("b.log", {encoder(1.0, 0.4), scan(1.05), encoder(1.1, 0.4)});
  const Outcome outcome = read(std::vector{a, b}, ScanRange{});
  ASSERT_EQ(outcome.turns.size(), 3U);
  EXPECT_NEAR(outcome.turns[0], 0.25 * 1.05, 1e-4);
  EXPECT_EQ(outcome.turns[1], -1.0);
  EXPECT_NEAR(outcome.turns[2], 0.25 * 1.45, 1e-4);
  EXPECT_EQ(outcome.count_of(kPast), 0U);
}

// The clock is set back by 5 s between two scans; the crank goes on turning, so the same stamps come with other counts.
// Scans 50 ms after their messages and such 20 ms before: the last one before the step waits, or has all it needs.
TEST_F(NoddingStreamOfLines, AClockThatIsSetBackCostsNoScanAndMixesNoTimes) {
  for (const double after_s : {0.05, -0.02}) {
    std::vector<std::string> lines;
    for (int k = 0; k < 160; ++k) {
      const double back_s = k < 80 ? 0.0 : 5.0;
      lines.push_back(encoder(1.0 + 0.1 * k - back_s, back_s));
      lines.push_back(scan(1.0 + after_s + 0.1 * k - back_s));
    }
    const Outcome outcome = read_lines(lines);
    ASSERT_EQ(outcome.turns.size(), 160U);
    // Beyond the messages at the log's end and beginning, and at the step, nothing is known.
    const std::vector<std::size_t> lost =
        after_s > 0.0 ? std::vector<std::size_t>{79, 159} : std::vector<std::size_t>{0, 80};
    for (std::size_t k = 0; k < 160; ++k) {
      const double turns = 0.25 * (1.0 + after_s + 0.1 * static_cast<double>(k));
      const bool is_lost = k == lost[0] || k == lost[1];
      EXPECT_NEAR(outcome.turns[k], is_lost ? -1.0 : turns - std::floor(turns), 1e-4) << "scan " << k;
    }
    EXPECT_EQ(outcome.count_of(kPast), 1U);
    EXPECT_EQ(outcome.count_of(kUncovered), 2U);
  }
}

TEST_F(NoddingStreamOfLines, OneStampFarAheadCostsAFewScans) {
  for (const double ahead_s : {3.0, 1e9}) {
    std::vector<std::string> lines;
    for (int k = 0; k < 100; ++k) {
      lines.push_back(k == 50 ? encoder(1.0 + 0.1 * k + ahead_s, -ahead_s) : encoder(1.0 + 0.1 * k));
      lines.push_back(scan(1.05 + 0.1 * k));
    }
    lines.push_back(encoder(11.0));
    const Outcome outcome = read_lines(lines);
    EXPECT_EQ(outcome.turns.size(), 100U);
    EXPECT_LE(outcome.count_of(kUncovered), 7U) << ahead_s;
    EXPECT_EQ(outcome.count_of(kPast), 1U);
    EXPECT_NEAR(outcome.turns.back(), 0.25 * 10.95 - 2.0, 1e-4);
  }
}

// A scan stamped far ahead waits for messages that never come; the others do not pay for it.
TEST_F(NoddingStreamOfLines, AScanStampedFarAheadCostsItself) {
  std::vector<std::string> lines;
  for (int k = 0; k < 3000; ++k) {
    lines.push_back(encoder(1.0 + 0.1 * k));
    lines.push_back(scan(k == 50 ? 1e6 : 1.05 + 0.1 * k));
  }
  lines.push_back(encoder(301.0));
  const Outcome outcome = read_lines(lines);
  EXPECT_EQ(outcome.turns.size(), 3000U);
  EXPECT_EQ(outcome.count_of(kUncovered), 1U);
  EXPECT_EQ(outcome.turns[50], -1.0);
}

TEST_F(NoddingStreamOfLines, ATiltIsItsOwnElevation) {
  const std::string path = write("a.log", {fmt_line("TILT 0.2", 1.0), scan(1.05), fmt_line("TILT 0.3", 1.1)});
  const Outcome outcome = read(std::vector{path}, ScanRange{}, NodKind::kTilt);
  // ElevationTable::identity(): half a turn is level.
  EXPECT_NEAR(outcome.turns.at(0), 0.5 + 0.25 / (2.0 * 3.14159265358979), 1e-6);
}

// Half a turn of the mirror, at five turns a second, the stamp in its middle: beams from 50 ms before to 50 ms after.
TEST_F(NoddingStreamOfLines, AScanHasThePositionFromItsFirstBeamToItsLast) {
  for (const double last_s : {1.16, 1.14}) {
    const std::string path = write("a.log", {encoder(1.0), scan(1.1), encoder(last_s)});
    calib::SweepModel model = calib::sweep_model_of_preset("paper-b");
    model.mirror_rate_hz = 5.0;
    ScanStream scans({path}, {}, {});
    NoddingStream stream(scans, NodKind::kEncoder, model, {});
    const std::optional<NoddingScan> found = stream.next();
    ASSERT_TRUE(found);
    ASSERT_NEAR(found->record.scan.bearing_step_rad, rad_from_deg(90.0), 1e-9);
    if (last_s < 1.15) {
      EXPECT_THAT(found->knots, IsEmpty()) << "its last beam is not covered";
      continue;
    }
    ASSERT_EQ(found->knots.size(), 2U);
    for (const auto& [knot, at_s] : {std::pair(found->knots[0], -0.05), std::pair(found->knots[1], 0.05)}) {
      EXPECT_NEAR(knot.offset_s, at_s, 1e-9);
      EXPECT_NEAR(static_cast<double>(knot.phase) / 4294967296.0, 0.25 * (1.1 + at_s), 1e-4);
    }
  }
}

}  // namespace
}  // namespace gdtslam
