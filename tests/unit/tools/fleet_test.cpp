// Logs of a fleet: how they are found and dealt out, what becomes of each, and what an atlas says of all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/fleet/atlas.hpp"
#include "engine/runs/fleet/fleet_work.hpp"
#include "engine/runs/transaction/folder_transaction.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Fleet : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  void write(const std::string& name, const std::string& text = "# no scan\n") const {
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name), std::ios::app) << text;
  }
  [[nodiscard]] std::vector<std::string> found(const std::vector<std::string>& names) const {
    std::vector<std::string> logs;
    for (const FleetLog& log : find_logs(names)) logs.push_back(log.path.substr(folder_.path().size() + 1));
    return logs;
  }
  /// The record that a run would have, with its report.
  void map_as(const std::string& log, const std::string& result, const std::string& outcome = "mapped") const {
    FleetRecord record{.log = log, .outcome = outcome, .run = "runs/" + name_in_atlas(log)};
    record.log_sha256 = "l" + log.substr(log.size() - 1);
    record.result_sha256 = result;
    write("atlas/" + record.run + "/report.json");
    write_record(path("atlas"), record);
  }
  [[nodiscard]] AtlasSummary summary() const { return summarise_atlas(read_atlas(path("atlas"))); }

  const TemporaryFolder folder_{"gdtslam-fleet-test"};
};

TEST_F(Fleet, LogsAreSearchedInFoldersTheLargestFirstAndEachOnce) {
  write("logs/b/small.log", "1");
  write("logs/large.log", "12345");
  write("logs/a.log", "123");
  write("logs/bag/metadata.yaml", "12");
  write("logs/bag/bag_0.db3", "12");
  write("logs/run/report.json");
  write("logs/run/trajectory.csv");
  write("logs/atlas/options.txt");
  write("logs/atlas/summary.csv");
  write("logs/.hidden/a.log");
  write("logs/notes.txt");
  fs::create_directory_symlink("..", path("logs/b/up"));
  EXPECT_THAT(found({path("logs"), path("logs/a.log"), path("logs/b/../large.log"), path("logs/./b/")}),
              ElementsAre("logs/large.log", "logs/bag", "logs/a.log", "logs/b/small.log"));
}

TEST_F(Fleet, ShardsHoldEveryLogOnce) {
  std::vector<FleetLog> logs;
  for (std::size_t k = 0; k < 10; ++k) logs.push_back({"/" + std::to_string(k), 100 - k});
  std::vector<bool> is_there(10);
  for (const char* text : {"1/4", "2/4", "3/4", "4/4"}) {
    for (const FleetLog& log : logs_of_shard(logs, parse_shard(text))) {
      EXPECT_FALSE(is_there[100 - log.bytes]);
      is_there[100 - log.bytes] = true;
    }
  }
  EXPECT_EQ(std::count(is_there.begin(), is_there.end(), true), 10);
  EXPECT_THAT(logs_of_shard(logs, parse_shard("11/11")), IsEmpty());
  for (const char* text : {"", "1", "/", "1/", "0/1", "2/1", "1/0", "-1/2", "1/2x", "x/2", "1/2/3"})
    EXPECT_THROW(parse_shard(text), UsageError) << text;
}

TEST_F(Fleet, ARecordReadsBackAndIsNoneIfItIsDamaged) {
  FleetRecord record{.log = "/logs/ä b.log", .outcome = "refused", .exit_code = 65, .reason = "\"line\" 1: no"};
  record.path_m = 0.1;
  record.bytes = 1U << 31U;
  write_record(path("atlas"), record);
  EXPECT_EQ(read_record(path("atlas"), record.log), record);
  EXPECT_EQ(read_record(path("atlas"), "/logs/other.log"), std::nullopt);
  const std::string file = record_folder(path("atlas"), record.log) + "/record.json";
  EXPECT_THAT(file, HasSubstr("/logs/___b.log-"));
  for (const char* text : {"", "{", "[]", "{\"log\": 1}"}) {
    std::ofstream(file) << text;
    EXPECT_EQ(read_record(path("atlas"), record.log), std::nullopt) << text;
  }
}

TEST_F(Fleet, TheHashDependsOnTheResultsAlone) {
  begin_atlas(path("atlas"), "options\n", {{"/x/a", 2}, {"/x/b", 2}});
  EXPECT_EQ(summary().missing, 2U);
  map_as("/x/a", "one");
  EXPECT_THAT(summary().sha256, IsEmpty());
  map_as("/x/b", "two");
  const std::string hash = summary().sha256;
  EXPECT_EQ(hash.size(), 64U);
  begin_atlas(path("atlas"), "options\n", {});
  map_as("/x/b", "two");
  EXPECT_EQ(summary().sha256, hash);
  map_as("/x/b", "three");
  EXPECT_NE(summary().sha256, hash);
  map_as("/x/b", "two", "failed");
  EXPECT_THAT(summary().sha256, IsEmpty());
  EXPECT_TRUE(atlas_json(summary()).at("atlas_sha256").is_null());
  map_as("/x/b", "two");
  fs::remove_all(path("atlas/runs/" + name_in_atlas("/x/b")));
  EXPECT_EQ(summary().missing, 1U);
}

TEST_F(Fleet, TheTableQuotesWhatIsAnybodys) {
  FleetRecord record{.log = "/a,b.log", .outcome = "refused", .exit_code = 65, .reason = "no \"x\"\nhere"};
  const std::string table = summary_csv({record});
  EXPECT_THAT(table, StartsWith("log,outcome,exit_code,reason,run,"));
  EXPECT_THAT(table, HasSubstr("\n\"/a,b.log\",refused,65,\"no \"\"x\"\"\nhere\",,0,"));
}

}  // namespace
}  // namespace gdtslam
