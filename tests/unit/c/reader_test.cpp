// Options and logs through the C interface: what is set is told again, what is read is what the log states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "c_support.hpp"

namespace gdtslam::c {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(COptions, are_those_of_the_command) {
  gdtslam_options* opened = nullptr;
  ASSERT_EQ(gdtslam_options_new(&opened, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_options> options(opened);
  ASSERT_EQ(gdtslam_options_set(opened, "map.resolution", "5 cm", nullptr), GDTSLAM_OK);
  std::vector<std::string> found;
  for (std::size_t k = 0; k < gdtslam_options_count(opened); ++k) {
    auto option = made<gdtslam_option>();
    ASSERT_EQ(gdtslam_options_at(opened, k, &option, nullptr), GDTSLAM_OK);
    if (std::string(option.path) == "map.resolution") found = {option.value, option.doc};
  }
  EXPECT_THAT(found, ElementsAre("0.05 m", "Edge of a cell of the map"));
  auto option = made<gdtslam_option>();
  EXPECT_EQ(gdtslam_options_at(opened, gdtslam_options_count(opened), &option, nullptr), GDTSLAM_USAGE);
}

TEST(CReader, gives_the_mount_that_was_stated_and_tells_how_far_it_is) {
  gdtslam_options* opened = nullptr;
  ASSERT_EQ(gdtslam_options_new(&opened, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_options> options(opened);
  const gdtslam_pose mount{0.2, 0.1, std::numbers::pi / 2};
  ASSERT_EQ(gdtslam_options_add_mount(opened, nullptr, &mount, nullptr), GDTSLAM_OK);
  gdtslam_reader* reader = nullptr;
  const char* const log = kSampleLog.c_str();
  ASSERT_EQ(gdtslam_reader_open(&log, 1, opened, GDTSLAM_NO_LOOPS, &reader, nullptr), GDTSLAM_USAGE);
  ASSERT_EQ(gdtslam_reader_open(&log, 1, opened, GDTSLAM_LENIENT, &reader, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_reader> owned(reader);
  auto scan = made<gdtslam_scan>();
  int32_t has_scan = 0;
  ASSERT_EQ(gdtslam_reader_next(reader, &scan, &has_scan, nullptr), GDTSLAM_OK);
  EXPECT_EQ(has_scan, 1);
  EXPECT_EQ(scan.range_count, 180U);
  EXPECT_EQ(scan.T_base_laser.theta_rad, mount.theta_rad);
  EXPECT_GT(gdtslam_reader_progress(reader), 0.0);
  while (has_scan != 0) ASSERT_EQ(gdtslam_reader_next(reader, &scan, &has_scan, nullptr), GDTSLAM_OK);
  EXPECT_EQ(gdtslam_reader_progress(reader), 1.0);
}

TEST(CReader, loses_no_scan_where_there_is_no_room_for_it) {
  const char* const log = kSampleLog.c_str();
  gdtslam_reader* reader = nullptr;
  ASSERT_EQ(gdtslam_reader_open(&log, 1, nullptr, 0, &reader, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_reader> owned(reader);
  gdtslam_scan unsized{};
  auto scan = made<gdtslam_scan>();
  int32_t has_scan = 0;
  int scans = -1;
  do {
    EXPECT_EQ(gdtslam_reader_next(reader, &unsized, &has_scan, nullptr), GDTSLAM_USAGE);
    ASSERT_EQ(gdtslam_reader_next(reader, &scan, &has_scan, nullptr), GDTSLAM_OK);
    ++scans;
  } while (has_scan != 0);
  EXPECT_EQ(scans, 350);  // as the sample log ships
}

TEST(CReader, counts_what_it_skips) {
  const TempDir folder;
  const std::string log = (folder.path() / "broken.log").string();
  std::ofstream(log) << "FLASER 3 1.0 2.0 3.0 0 0 0 0 0 0 1.0 host 1.0\nFLASER 3 1.0 two 3.0 0 0 0 0 0 0 2.0 host 2.0\n"
                        "FLASER 3 1.0 2.0 3.0 0 0 0 0 0 0 3.0 host 3.0\n";
  const char* const path = log.c_str();
  gdtslam_reader* reader = nullptr;
  ASSERT_EQ(gdtslam_reader_open(&path, 1, nullptr, GDTSLAM_LENIENT, &reader, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_reader> owned(reader);
  auto scan = made<gdtslam_scan>();
  int32_t has_scan = 1;
  int scans = -1;
  for (; has_scan != 0; ++scans) ASSERT_EQ(gdtslam_reader_next(reader, &scan, &has_scan, nullptr), GDTSLAM_OK);
  EXPECT_EQ(scans, 2);
  auto warning = made<gdtslam_log_warning>();
  int32_t has_warning = 0;
  ASSERT_EQ(gdtslam_reader_warning(reader, 0, &warning, &has_warning, nullptr), GDTSLAM_OK);
  ASSERT_EQ(has_warning, 1);
  EXPECT_EQ(warning.count, 1U);
  EXPECT_THAT(warning.first, HasSubstr(log + ":2"));
  ASSERT_EQ(gdtslam_reader_warning(reader, 9, &warning, &has_warning, nullptr), GDTSLAM_OK);
  EXPECT_EQ(has_warning, 0);
}

}  // namespace
}  // namespace gdtslam::c
