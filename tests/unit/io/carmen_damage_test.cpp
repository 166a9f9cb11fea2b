// Damaged and hostile logs: one stated outcome each, within a second and 256 MB (docs/formats.md lists them).
#include <gmock/gmock.h>

#include <limits>

#include "engine/io/logs/carmen.hpp"
#include "engine/io/text_log.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kSmallLog =
    "# a small log\n"
    "PARAM robot_frontlaser_offset -0.04 1071.5 merci 1071.4\n"
    "ODOM 0.1 0.2 0.3 0.4 0.5 0.6 1071.6 merci 1071.5\n"
    "FLASER 3 1.25 2.5 81.83 0.06 0.2 0.3 0.1 0.2 0.3 1071.7 merci 1071.6\n"
    "ENCODER 1234 1071.8 merci 1071.7\n"
    "TILT 0.125 1071.9 merci 1071.8\n"
    "FLASER 3 1.5 2.75 3.5 0.16 0.2 0.3 0.2 0.2 0.3 1072.0 merci 1071.9\n";

std::string carmen_error(std::string_view text, const ReadOptions& options = {}) {
  try {
    read_text(text, options);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}

std::string scan_line(const std::string& ranges, int beams, const std::string& stamp = "5") {
  return "FLASER " + std::to_string(beams) + " " + ranges + " 0 0 0 0 0 0 " + stamp + " h 0\n";
}

TEST(CarmenDamage, NulBytesAtTheEndAreACutLine) {
  std::string text(kSmallLog);
  while (text.size() < 5000) {
    text += kSmallLog;
  }
  const std::size_t records = read_text(text).records.size();
  const WholeLog log = read_text(text + std::string(4096, '\0'));
  EXPECT_EQ(log.records.size(), records);
  EXPECT_EQ(log.warned("cut last line"), 1U);
}

TEST(CarmenDamage, GigabyteLineIsAnErrorWithoutReadingIt) {
  const std::string block = gzip(std::string(std::size_t{16} << 20U, '7'));
  std::string packed = gzip("# one\nFLASER 1 ");
  for (int i = 0; i < 64; ++i) {
    packed += block;
  }
  const BoundedRun run =
      run_alone([&] { return carmen_error(packed).find("test.log:2: the line \"FLASER\" is longer") == 0 ? 0 : 1; });
  EXPECT_EQ(run.code, 0);
  expect_bounded(run);
}

TEST(CarmenDamage, NotANumberAndNegativeRangesAreNoReturns) {
  const WholeLog log = read_text(scan_line("1.5 nan -1 NaN -0.25 inf 2.5 -inf", 8));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_THAT(log.of<ScanRecord>().at(0).scan.ranges_m,
              ::testing::ElementsAre(1.5F, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, 2.5F, kInfinity));
  EXPECT_EQ(log.warned("range not a number"), 2U);
  EXPECT_EQ(log.warned("negative range"), 3U);
  const WholeLog clean = read_text(scan_line("1.5 inf inf inf inf inf 2.5 inf", 8));
  EXPECT_EQ(log.of<ScanRecord>().at(0).scan.ranges_m, clean.of<ScanRecord>().at(0).scan.ranges_m);
  EXPECT_TRUE(clean.warnings.empty());
}

TEST(CarmenDamage, MalformedLinesNameFileLineAndFault) {
  const std::string good = scan_line("1 2", 2);
  struct Case {
    std::string line;
    std::string fault;
  };
  for (const Case& c :
       {Case{"FLASER 2 1 x 0 0 0 0 0 0 5 h 0", "has \"x\" as its range, which is not a number"},
        Case{"FLASER 1 1 2 0 0 0 0 0 0 5 h 0", "has \"h\" as its logger_timestamp"},
        Case{"FLASER 1 1 0 0 0 0 0 0 5 h 0 9", "goes on with \"9\""},
        Case{"FLASER 2 1 2 0 0 nan 0 0 0 5 h 0", "has \"nan\" as its laser pose, which is not a finite"},
        Case{"FLASER 2 1 2 0 0 0 0 0 0 inf h 0", "ipc_timestamp"},
        Case{"FLASER 2.5 1 2 0 0 0 0 0 0 5 h 0", "which is not a whole number"},
        Case{"FLASER 2 1 2 0 0 0 0 0 0 5 h", "ends before its logger_timestamp"},
        Case{"ODOM 1 2", "ends before its robot pose"}, Case{"ENCODER 1.5 2 h 3", "\"1.5\" as its ticks"},
        Case{"TILT inf 2 h 3", "elevation"}, Case{"PARAM", "ends before its parameter name"},
        Case{"ROBOTLASER1 0 -1 3 0 80 0 0 1 5 0 0 0 0 0 0 0 0 0 0 0 0 5 h 0", "angular resolution"},
        Case{"ROBOTLASER1 0 -9 3 1 80 0 0 1 5 0 0 0 0 0 0 0 0 0 0 0 0 5 h 0", "start_angle"},
        Case{"ROBOTLASER1 0 -1 3 1 -80 0 0 1 5 0 0 0 0 0 0 0 0 0 0 0 0 5 h 0", "negative maximum range"},
        Case{"1 2 3", "starts with \"1\", which is no CARMEN message"}}) {
    const std::string text = good + c.line + "\n" + good;
    const std::string error = carmen_error(text);
    EXPECT_THAT(error, HasSubstr("test.log:2: ")) << c.line;
    EXPECT_THAT(error, HasSubstr(c.fault)) << c.line;
    EXPECT_THAT(error, HasSubstr("--lenient")) << c.line;
    const WholeLog log = read_text(text, {.lenient = true});
    EXPECT_EQ(log.records.size(), 2U) << c.line;
    EXPECT_EQ(log.warned("malformed line"), 1U) << c.line;
  }
}

TEST(CarmenDamage, UnprintableBytesNeverReachAMessage) {
  const std::string error = carmen_error(scan_line("1", 1) + "FLASER 1 \x1b[31m\x07 0\n");
  EXPECT_EQ(error.find('\x1b'), std::string::npos);
  EXPECT_EQ(error.find('\x07'), std::string::npos);
}

}  // namespace
}  // namespace gdtslam
