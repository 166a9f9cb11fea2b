// Every status but one is provoked here, with its text; that of a picture without fonts is in
// tests/bindings/python_test.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "c_support.hpp"

namespace gdtslam::c {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class CErrors : public ::testing::Test {
 protected:
  gdtslam_status map_with(gdtslam_progress progress) {
    const char* const log = kSampleLog.c_str();
    const std::string folder = (temp_.path() / "run").string();
    auto request = made<gdtslam_map_request>();
    request.logs = &log;
    request.log_count = 1;
    request.folder = folder.c_str();
    request.flags = GDTSLAM_NO_LOOPS | GDTSLAM_NO_PICTURES;
    request.progress = progress;
    gdtslam_run* run = nullptr;
    const gdtslam_status status = gdtslam_map_logs(&request, &run, &error_);
    run_.reset(run);
    return status;
  }

  TempDir temp_;
  gdtslam_error error_ = made<gdtslam_error>();
  Owned<gdtslam_run> run_;
};

TEST_F(CErrors, wrong_usage_is_null_where_something_is_needed) {
  EXPECT_EQ(gdtslam_map_log(nullptr, "folder", nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_STREQ(error_.text, "gdtslam_map_log: log is NULL");
  EXPECT_EQ(error_.status, GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_options_new(nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_run_open("folder", nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_mapper_process(nullptr, nullptr, nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_localizer_new(nullptr, nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_grid_look(nullptr, nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_tracker_follow(nullptr, nullptr, nullptr, &error_), GDTSLAM_USAGE);
}

TEST_F(CErrors, what_frees_and_tells_takes_null) {
  for (const auto& free : {+[] { gdtslam_options_free(nullptr); }, +[] { gdtslam_reader_free(nullptr); },
                           +[] { gdtslam_mapper_free(nullptr); }, +[] { gdtslam_grid_free(nullptr); },
                           +[] { gdtslam_run_free(nullptr); }, +[] { gdtslam_bytes_free(nullptr); },
                           +[] { gdtslam_localizer_free(nullptr); }, +[] { gdtslam_tracker_free(nullptr); }}) {
    free();
  }
  EXPECT_STREQ(gdtslam_run_map_sha256(nullptr), "");
  EXPECT_STREQ(gdtslam_grid_sha256(nullptr), "");
  EXPECT_EQ(gdtslam_bytes_count(nullptr), 0U);
  EXPECT_EQ(gdtslam_options_count(nullptr), 0U);
}

TEST_F(CErrors, bad_configuration_has_the_words_of_the_command) {
  gdtslam_options* made_options = nullptr;
  ASSERT_EQ(gdtslam_options_new(&made_options, &error_), GDTSLAM_OK);
  const Owned<gdtslam_options> options(made_options);
  EXPECT_EQ(gdtslam_options_set(options.get(), "map.resolutoin", "5 cm", &error_), GDTSLAM_BAD_CONFIG);
  EXPECT_STREQ(error_.text, "unknown option \"map.resolutoin\"; did you mean map.resolution?");
  EXPECT_EQ(gdtslam_options_set(options.get(), "map.resolution", "5", &error_), GDTSLAM_BAD_CONFIG);
  EXPECT_THAT(error_.text, EndsWith("'5' needs a unit: 5 cm, 5 m"));
  EXPECT_EQ(gdtslam_options_set(options.get(), "map.resolution", "5 km", &error_), GDTSLAM_BAD_CONFIG);
  EXPECT_STREQ(error_.text, "map.resolution: \"5 km\" is above its maximum 1 m");
  EXPECT_EQ(gdtslam_options_set(options.get(), "map.resolution", "7,5 cm", &error_), GDTSLAM_BAD_CONFIG);
  EXPECT_THAT(error_.text, HasSubstr("map.resolution: \"7,5 cm\" is no value of it: unit ',5 cm' does not fit here"));
  EXPECT_EQ(gdtslam_options_set(options.get(), "log.mount_x", "1 m", &error_), GDTSLAM_OK);
  EXPECT_STREQ(error_.text, "") << "what options ask of each other is looked at when they are taken";
  auto request = made<gdtslam_mapper_request>();
  request.options = options.get();
  gdtslam_mapper* mapper = nullptr;
  EXPECT_EQ(gdtslam_mapper_new(&request, &mapper, &error_), GDTSLAM_BAD_CONFIG);
  EXPECT_THAT(error_.text, HasSubstr("log.mount_x"));
}

TEST_F(CErrors, the_caller_interrupts_and_gets_what_there_is) {
  const auto end = [](void*, const char* step, uint64_t scans, double) -> int32_t {
    return std::strcmp(step, "scans") == 0 && scans >= 40 ? 1 : 0;
  };
  EXPECT_EQ(map_with(+end), GDTSLAM_INTERRUPTED);
  EXPECT_THAT(error_.text, StartsWith("interrupted after 40 scans; their results are in "));
  ASSERT_NE(run_, nullptr);
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(gdtslam_run_trajectory(run_.get(), &poses, &count, nullptr), GDTSLAM_OK);
  EXPECT_EQ(count, 40U);
}

#if !defined(GDTSLAM_SANITIZE_ADDRESS) && !defined(GDTSLAM_SANITIZE_THREAD)  // whose new does not fail
TEST_F(CErrors, memory_that_there_is_not) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr std::size_t kMany = std::size_t{1} << 29U;  // 2 GiB of ranges
    std::ifstream statm("/proc/self/statm");
    std::size_t pages = 0;
    statm >> pages;
    const rlim_t now = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const rlimit limit{now + (rlim_t{1} << 30U), now + (rlim_t{1} << 30U)};
    gdtslam_mapper* mapper = nullptr;
    if (gdtslam_mapper_new(nullptr, &mapper, nullptr) != GDTSLAM_OK || ::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(1);
    const float range = 1.0F;
    auto scan = made<gdtslam_scan>();
    scan.ranges_m = &range;  // nothing is read where there is no room for it
    scan.range_count = kMany;
    const gdtslam_status status = gdtslam_mapper_process(mapper, &scan, nullptr, &error_);
    ::_exit(status == GDTSLAM_OUT_OF_MEMORY && std::strcmp(error_.text, "out of memory") == 0 ? 0 : 2);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}
#endif

TEST_F(CErrors, texts_are_cut_between_characters_to_the_room_that_there_is) {
  struct {
    gdtslam_error error;
    char more[64];
  } larger{};
  std::string name = "x/";
  while (name.size() < 1100) name += "\xC3\xA4";  // an umlaut, two bytes
  larger.error.size = sizeof(larger);
  EXPECT_EQ(gdtslam_map_log(name.c_str(), "f", nullptr, &error_), GDTSLAM_INPUT_OUTPUT);
  EXPECT_EQ(std::string(error_.text), name.substr(0, 1010)) << "not 1011, which is within a letter";
  EXPECT_EQ(gdtslam_map_log(name.c_str(), "f", nullptr, &larger.error), GDTSLAM_INPUT_OUTPUT);
  EXPECT_GT(std::strlen(larger.error.text), 1010U) << "there is room behind the struct";
  auto small = made<gdtslam_error>();
  small.size = offsetof(gdtslam_error, text);
  small.text[0] = '!';
  EXPECT_EQ(gdtslam_map_log(nullptr, "f", nullptr, &small), GDTSLAM_USAGE);
  EXPECT_EQ(small.text[0], '!') << "no room for a text";
}

}  // namespace
}  // namespace gdtslam::c
