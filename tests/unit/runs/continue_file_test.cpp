// What continue.json keeps of a request comes back as it was, and what it does not keep stays as it is asked for anew.
#include "engine/runs/continuing/continue_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ContinueFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // Of each kind of field another value than its default, one switch at a time turned round.
  static KeptRequest unusual(int turned_round) {
    KeptRequest kept;
    MapRequest& request = kept.request;
    request.linkage = "paper-b";
    request.range.skip = 17;
    request.range.count = 230;
    int k = 0;
    for (bool* part :
         {&request.lenient, &request.with_cloud, &request.with_map, &request.with_loops, &request.with_pictures}) {
      if (k++ == turned_round) *part = !*part;
    }
    request.settings.mapper.map.resolution_m = 0.03125;
    request.settings.log.topics = {.scans = {"/front", "/back"},
                                   .odometry = "/wheels",
                                   .crank = "/ticks",
                                   .mounts = {{"/back", {-0.25, 0.5, -3.0}}, {"/front", {0.125, -0.5, 1.5}}}};
    kept.logs = {{"a.log", "/logs/a.log", std::string(64, 'a')}, {"-", "log-2.jsonl.zst", std::string(64, 'b')}};
    return kept;
  }
  [[nodiscard]] std::string file() const { return (folder_ / "continue.json").string(); }
  [[nodiscard]] KeptRequest read() const { return read_continue_file(file(), folder_.string()); }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-continue-" + std::to_string(::getpid()));
};

TEST_F(ContinueFileTest, WhatIsKeptComesBack) {
  for (int turned_round = 0; turned_round < 5; ++turned_round) {
    const KeptRequest kept = unusual(turned_round);
    write_continue_file(file(), kept);
    const KeptRequest back = read();
    ASSERT_EQ(back.logs.size(), 2U);
    EXPECT_EQ(back.logs[0].name, "a.log");
    EXPECT_EQ(back.logs[0].path, "/logs/a.log");
    EXPECT_EQ(back.logs[1].path, "log-2.jsonl.zst");
    EXPECT_EQ(back.logs[1].sha256, std::string(64, 'b'));
    EXPECT_EQ(back.request.linkage, "paper-b");
    EXPECT_EQ(back.request.range.skip, 17U);
    EXPECT_EQ(back.request.range.count, 230U);
    EXPECT_EQ(back.request.lenient, kept.request.lenient);
    EXPECT_EQ(back.request.with_cloud, kept.request.with_cloud);
    EXPECT_EQ(back.request.with_map, kept.request.with_map);
    EXPECT_EQ(back.request.with_loops, kept.request.with_loops);
    EXPECT_EQ(back.request.with_pictures, kept.request.with_pictures);
    EXPECT_EQ(back.request.settings.mapper.map.resolution_m, 0.03125);
    const TopicChoice& topics = back.request.settings.log.topics;
    EXPECT_THAT(topics.scans, testing::ElementsAre("/front", "/back"));
    EXPECT_EQ(topics.odometry, "/wheels");
    EXPECT_EQ(topics.crank, "/ticks");
    ASSERT_EQ(topics.mounts.size(), 2U);
    EXPECT_EQ(topics.mounts[0].topic, "/back");
    EXPECT_EQ(topics.mounts[0].T_base_laser, (Pose2{-0.25, 0.5, -3.0}));
    EXPECT_EQ(topics.mounts[1].T_base_laser, (Pose2{0.125, -0.5, 1.5}));
  }
}

TEST_F(ContinueFileTest, ALogIsFoundByItsBytes) {
  const std::string log = (folder_ / "log-1.jsonl.zst").string();
  std::ofstream(log) << "one\n";
  const KeptLog kept = kept_log(log, state_of_file(log), "");
  const KeptLog own = kept_log("-", std::nullopt, log);
  // printf 'one\n' | sha256sum
  EXPECT_EQ(kept.sha256, "2c8b08da5ce60398e1f19af0e5dccc744df274b826abe585eaba68c525434806");
  EXPECT_EQ(own.path, "log-1.jsonl.zst") << "of the run";
  EXPECT_EQ(log_of_run(kept, "elsewhere"), log);
  EXPECT_EQ(log_of_run(own, folder_.string()), log);
  for (const char* path : {"../log-1.jsonl.zst", "..", "", "continue.json"}) {
    EXPECT_THROW((void)log_of_run({"-", path, own.sha256}, folder_.string()), InputError) << path;
  }
  const std::optional<FileState> before = state_of_file(log);
  std::ofstream(log) << "two\n";
  EXPECT_THROW((void)log_of_run(kept, "elsewhere"), InputError);
  EXPECT_EQ(kept_log(log, before, "").sha256, "") << "written to while it was mapped";
}

// A stranger's file is not read, whatever it is and whoever named it.
TEST_F(ContinueFileTest, FilesOfAnotherHashAreRefusedBeforeTheyAreRead) {
  const std::string secret = (folder_ / "secret").string();
  std::ofstream(secret) << "FLASER 1 2.0 0 0 0 0 0 0 1 robot 1\n";
  KeptRequest kept;
  kept.logs = {{"a.log", secret, std::string(64, 'a')}};
  write_continue_file(file(), kept);
  const MapRequest request{.continued = folder_.string()};
  const auto fault = [&request] {
    try {
      (void)continued_request(request);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  EXPECT_THAT(fault(), HasSubstr(secret + ": has another SHA-256 than the log"));
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(std::ifstream(file()));
  json["linkage"] = secret;
  std::ofstream(file()) << json.dump();
  EXPECT_THAT(fault(), HasSubstr(secret + ": has another SHA-256 than the linkage"));
  json["linkage"] = "/dev/zero";
  std::ofstream(file()) << json.dump();
  EXPECT_THAT(fault(), HasSubstr("/dev/zero: has another SHA-256"));
}

}  // namespace
}  // namespace gdtslam
