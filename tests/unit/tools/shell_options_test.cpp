// Whole numbers and mounts on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

std::uint64_t parsed_count(const std::string& text) {
  CLI::App app;
  std::uint64_t count = 77;
  add_count_option(app, "--count", count, 1, "");
  app.parse("--count " + text);
  return count;
}

std::int32_t number_in_range(const std::string& text) {
  CLI::App app;
  std::int32_t number = 77;
  app.add_option("--number", number)->transform(without_leading_zeros())->check(CLI::Range(0, 100));
  app.parse("--number=" + text);
  return number;
}

TEST(WholeNumbers, AreDecimalWhateverTheyBeginWith) {
  EXPECT_EQ(parsed_count("10"), 10U);
  EXPECT_EQ(parsed_count("010"), 10U);
  EXPECT_EQ(parsed_count("08"), 8U);
  EXPECT_EQ(parsed_count("0018446744073709551615"), UINT64_MAX);
  EXPECT_EQ(number_in_range("0077"), 77);
  EXPECT_EQ(number_in_range("09"), 9);
  EXPECT_EQ(number_in_range("00"), 0);
  EXPECT_EQ(number_in_range("0"), 0);
  for (const char* const text : {"000", "-1", "0x10", "1.5", "08a", "18446744073709551616"}) {
    EXPECT_THROW(parsed_count(text), CLI::ValidationError) << text;
  }
  EXPECT_THROW(number_in_range("0101"), CLI::ValidationError);
  EXPECT_THROW(number_in_range(""), CLI::ParseError);
}

std::string mount_refusal(const std::vector<std::string>& mounts) {
  LogConfig config;
  try {
    state_recording({.topics = {}, .odometry = {}, .crank = {}, .mounts = mounts}, config);
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(Mounts, LieWithinTheBoundsOfTheirOptions) {
  EXPECT_EQ(mount_refusal({"0.2m,-100m,180deg"}), "");
  EXPECT_EQ(mount_refusal({"0,0,360deg", "/a=1m,0,0", "b=1m,0,0"}), "");
  for (const std::string laser : {"", "/scan=", "scan="}) {
    EXPECT_THAT(mount_refusal({laser + "0,0,370deg"}), HasSubstr("--mount: log.mount_angle: 370 deg"));
    EXPECT_THAT(mount_refusal({laser + "101m,0,0"}), HasSubstr("--mount: log.mount_x: "));
    EXPECT_THAT(mount_refusal({laser + "0,-101m,0"}), HasSubstr("--mount: log.mount_y: "));
  }
}

TEST(Mounts, AreStatedOnceEach) {
  EXPECT_THAT(mount_refusal({"1m,0,0", "2m,0,0"}), HasSubstr("NAME=x,y,yaw"));
  EXPECT_THAT(mount_refusal({"/a=1m,0,0", "/b=1m,0,0", "a=2m,0,0"}), HasSubstr("\"a\" is given twice"));
}

}  // namespace
}  // namespace gdtslam
