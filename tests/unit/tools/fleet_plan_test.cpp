// Plans of a fleet: what is written reads back, what is damaged is refused, logs are found by their names, and shards
// are packed and chosen.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "engine/runs/fleet/collect.hpp"
#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/shards.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

FleetPlan small_plan() {
  FleetPlan plan;
  plan.program = {"0.1.0", std::string(64, 'a'), std::string(64, 'b')};
  plan.config = "version: 1\n\"quoted\"\n";
  plan.reading = {{"/scan"}, "/odom", "", {"0.2m,0,180deg"}, true};
  plan.get = "aws s3 cp {} -";
  plan.units = {{"/logs/a.log", 10}, {"/logs/b\xc3\xa4 \x1b.log", 0}, {"s3://c/d.bag", 12345678901}};
  plan.shards = {{1}, {0, 2}};
  return plan;
}

std::string message_of(const std::string& text) {
  try {
    parse_plan(text, "plan.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(FleetPlan, ReadsBackAsItWasWritten) {
  const FleetPlan plan = small_plan();
  const FleetPlan read = parse_plan(plan_text(plan), "plan.json");
  EXPECT_EQ(read.program, plan.program);
  EXPECT_EQ(read.config, plan.config);
  EXPECT_EQ(read.reading, plan.reading);
  EXPECT_EQ(read.get, plan.get);
  EXPECT_EQ(read.units, plan.units);
  EXPECT_EQ(read.shards, plan.shards);
  EXPECT_EQ(plan_text(read), plan_text(plan));
  for (const char c : plan_text(plan)) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << "a terminal may obey it";
}

TEST(FleetPlan, HoldsUtf8Alone) {
  const auto is_refused = [](auto&& change) {
    FleetPlan plan = small_plan();
    change(plan, "/sc\xC3\xA4n");
    EXPECT_NO_THROW(plan_text(plan));
    change(plan, "/sc\xE4n");
    try {
      plan_text(plan);
    } catch (const UsageError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, HasSubstr("/sc\\ufffdn"));
      return message.find('\n') == std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(is_refused([](FleetPlan& plan, const char* text) { plan.reading.topics = {"/a", text}; }));
  EXPECT_TRUE(is_refused([](FleetPlan& plan, const char* text) { plan.reading.crank = text; }));
  EXPECT_TRUE(is_refused([](FleetPlan& plan, const char* text) { plan.linkage = text; }));
  EXPECT_TRUE(is_refused([](FleetPlan& plan, const char* text) { plan.get = text; }));
}

TEST(FleetPlan, RefusesWhatIsDamagedInOneLine) {
  const std::string text = plan_text(small_plan());
  for (std::size_t cut = 0; cut + 2 < text.size(); ++cut) {
    const std::string message = message_of(text.substr(0, cut));
    ASSERT_NE(message, "") << cut;
    ASSERT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_THAT(message_of(replaced(text, "\"format\": 1", "\"format\": 2")), HasSubstr("another format"));
  EXPECT_THAT(message_of(replaced(text, "[0,2]", "[0,1,2]")), HasSubstr("unit 1 in a shard"));
  EXPECT_THAT(message_of(replaced(text, "[0,2]", "[2,0]")), HasSubstr("unit 0 in a shard"));
  EXPECT_THAT(message_of(replaced(text, "[0,2]", "[2]")), HasSubstr("in no shard"));
  EXPECT_THAT(message_of(replaced(text, "[0,2]", "[0,3]")), HasSubstr("no unit's"));
  EXPECT_THAT(message_of(replaced(text, "/logs/a", "/zogs/a")), HasSubstr("out of order"));
  EXPECT_THAT(message_of(replaced(text, "10]", "-10]")), HasSubstr("a unit that is none"));
  EXPECT_THAT(message_of(replaced(text, "\"units\"", "\"runits\"")), HasSubstr("a key is missing"));
}

TEST(FleetPlan, IsWrittenOnce) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string atlas = folder.path() + "/atlas";
  FleetPlan plan = small_plan();
  EXPECT_TRUE(write_plan(atlas, plan));
  EXPECT_FALSE(write_plan(atlas, plan));
  const std::string id = read_plan(atlas).id;
  EXPECT_EQ(id.size(), 16U);
  plan.config += "# another\n";
  EXPECT_THROW(write_plan(atlas, plan), UsageError);
  EXPECT_EQ(read_plan(atlas).id, id);
  std::filesystem::create_directories(folder.path() + "/old/units");
  EXPECT_THROW(write_plan(folder.path() + "/old", plan), UsageError);
  EXPECT_THROW(read_plan(folder.path()), FileError);
}

// Of several that plan into a folder at once one does; the others are told as if its plan had been there before.
TEST(FleetPlan, IsWrittenByOneOfSeveral) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  constexpr std::size_t kRounds = 30;
  for (std::size_t round = 0; round < kRounds; ++round) {
    const std::string atlas = fmt::format("{}/{}", folder.path(), round);
    std::array<bool, 4> wrote{};
    {
      std::vector<std::jthread> threads;
      for (std::size_t k = 0; k < wrote.size(); ++k) {
        threads.emplace_back([&, k] {
          FleetPlan plan = small_plan();
          plan.config += fmt::format("# {}\n", k);
          try {
            wrote[k] = write_plan(atlas, plan);
          } catch (const UsageError&) {
            wrote[k] = false;
          }
        });
      }
    }
    ASSERT_EQ(std::count(wrote.begin(), wrote.end(), true), 1);
    const auto first = static_cast<std::size_t>(std::find(wrote.begin(), wrote.end(), true) - wrote.begin());
    EXPECT_THAT(read_plan(atlas).plan.config, EndsWith(fmt::format("# {}\n", first)));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(atlas), {}), 1) << "a temporary file is left";
  }
}

TEST(FleetUnits, AreFoundByTheirNames) {
  for (const char* name : {"a.log", "a.clf.gz", "b.csv.zst", "c.jsonl.xz", "d.bag.bz2", "e.mcap", "f.db3"})
    EXPECT_TRUE(has_name_of_a_log(name)) << name;
  for (const char* name : {"a.txt", ".log", "a.log.zip", "log", "a.linkage.yaml", ".gz", "a.tum"})
    EXPECT_FALSE(has_name_of_a_log(name)) << name;
}

TEST(FleetUnits, AreSearchedInFolders) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string root = folder.path();
  const auto write = [&root](const std::string& name, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(root + "/" + name).parent_path());
    std::ofstream(root + "/" + name) << text;
  };
  write("b/deep/one.log", "12345");
  write("a.csv", "1");
  write("notes.txt", "");
  write(".hidden/two.log", "");
  write("run/report.json", "");
  write("run/covariance.csv", "");
  write("ros/metadata.yaml", "123");
  write("ros/ros_0.db3", "1234");
  UnitCollector collector;
  collector.add(root);
  collector.add(root + "/b/deep/../deep/one.log");
  collector.add("s3://bucket/x.bag");
  collector.add_list("# comment\n\n" + root + "/a.csv\r\nhttps://host/y.log\t77\n", "list");
  const CollectedUnits found = collector.take();
  EXPECT_EQ(found.twice, 2U);
  EXPECT_THAT(found.units, ElementsAre(FleetUnit{root + "/a.csv", 1}, FleetUnit{root + "/b/deep/one.log", 5},
                                       FleetUnit{root + "/ros", 7}, FleetUnit{"https://host/y.log", 77},
                                       FleetUnit{"s3://bucket/x.bag", 0}));
}

TEST(FleetUnits, AreNotTheTablesOfAFolderOfResults) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  std::ofstream(folder.path() + "/covariance.csv") << "1";
  for (const char* name : {"/report.json", "/plan.json"}) {
    std::ofstream(folder.path() + name) << "{}";
    UnitCollector collector;
    EXPECT_THROW(collector.add(folder.path()), InputError) << name;
    std::filesystem::remove(folder.path() + name);
  }
}

TEST(FleetUnits, LinksInFoldersAreLeftOutAndCounted) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string root = folder.path();
  std::ofstream(root + "/a.log") << "1";
  for (const char* name : {"/b.log", "/notes.txt", "/.hidden.log"})
    std::filesystem::create_symlink("a.log", root + name);
  std::filesystem::create_directory_symlink(".", root + "/again");
  UnitCollector collector;
  collector.add(root);
  const CollectedUnits found = collector.take();
  EXPECT_THAT(found.units, ElementsAre(FleetUnit{root + "/a.log", 1}));
  EXPECT_EQ(found.links, 2U) << "b.log and again";
}

TEST(FleetUnits, AboveALinkAreWhereItLeads) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string root = folder.path();
  std::filesystem::create_directories(root + "/far/away");
  std::filesystem::create_directory_symlink("far/away", root + "/link");
  std::ofstream(root + "/a.log") << "1";
  std::ofstream(root + "/far/a.log") << "22";
  std::ofstream(root + "/far/away/b.log") << "333";
  UnitCollector collector;
  collector.add(root + "/link/../a.log");
  collector.add_list(root + "/link/./../a.log\n" + root + "/link/../listed.log\t7\n", "list");
  collector.add(root + "//link/b.log");
  collector.add(root + "/far/../link/");
  const CollectedUnits found = collector.take();
  EXPECT_THAT(found.units, ElementsAre(FleetUnit{root + "/far/a.log", 2}, FleetUnit{root + "/far/listed.log", 7},
                                       FleetUnit{root + "/link/b.log", 3}));
}

TEST(FleetUnits, OfAListAreRefusedWithTheirLine) {
  const auto message = [](const std::string& text) -> std::string {
    UnitCollector collector;
    try {
      collector.add_list(text, "list");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("s3://a/b\ns3://a/c\tmany\n"), HasSubstr("list:2: \"many\" is no number of bytes"));
  EXPECT_THAT(message("s3://a/b\n\t77\n"), HasSubstr("list:2: names no log before its tab"));
  EXPECT_THAT(message("/dev/zero\n"), HasSubstr("list:1: /dev/zero: is no plain file"));
  EXPECT_THAT(message("/there/is/none.log\n"), HasSubstr("list:1: /there/is/none.log"));
  EXPECT_THAT(message("s3://a/\xff\t1\n"), HasSubstr("list:1:"));
  const TemporaryFolder folder("gdtslam-fleet-test");
  EXPECT_THAT(message(folder.path() + "\t1\n"), HasSubstr("list:1: is a folder and no ROS 2 bag"));
  std::ofstream(folder.path() + "/metadata.yaml") << "x";
  EXPECT_EQ(message(folder.path() + "\t1\n"), "");
}

TEST(FleetShards, HoldEveryUnitOnceAndAreEven) {
  std::vector<FleetUnit> units;
  for (std::uint64_t k = 1; k <= 1000; ++k) units.push_back({"/" + std::to_string(k), k * 10'000});
  const auto shards = packed_shards(units, 7);
  ASSERT_EQ(shards.size(), 7U);
  std::vector<bool> seen(units.size());
  for (const auto& shard : shards) {
    std::uint64_t bytes = 0;
    for (std::size_t k = 0; k < shard.size(); ++k) {
      EXPECT_FALSE(seen[shard[k]]);
      EXPECT_TRUE(k == 0 || shard[k - 1] < shard[k]);
      seen[shard[k]] = true;
      bytes += units[shard[k]].bytes;
    }
    // A list scheduled by falling size ends at most one smallest unit apart from the mean here.
    EXPECT_NEAR(static_cast<double>(bytes), 5005.0 * 1e6 / 7.0, 1e5);
  }
  EXPECT_THAT(seen, ::testing::Each(true));
}

TEST(FleetShards, AreTenMinutesEachAndAtMostAThousand) {
  const std::vector<FleetUnit> hour(60, {"/x.log", 55'000'000});  // a minute each: 5 s, and a megabyte a second
  EXPECT_EQ(packed_shards(hour, 0).size(), 6U);
  EXPECT_EQ(packed_shards({{"/x.log", 1}}, 0).size(), 1U);
  EXPECT_EQ(packed_shards({{"/x.log", 1}, {"/y.log", 1}}, 5).size(), 2U);
  EXPECT_EQ(packed_shards(std::vector<FleetUnit>(3000, {"/x.log", 2'000'000'000}), 0).size(), kMostShards);
  EXPECT_GT(estimated_work_s({"/x.log.gz", 1000}), estimated_work_s({"/x.log", 1000}));
}

ShardChoice automatic(const std::map<std::string, std::string>& variables) {
  return shard_choice("auto", [&variables](const char* name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    return found == variables.end() ? std::nullopt : std::optional(found->second);
  });
}

std::vector<std::size_t> chosen(const std::string& text, std::size_t shards) {
  return chosen_shards(shard_choice(text, {}), shards);
}

TEST(FleetShards, AreChosenByNumber) {
  EXPECT_THAT(chosen("1", 3), ElementsAre(0));
  EXPECT_THAT(chosen("3/3", 3), ElementsAre(2));
  EXPECT_THAT(chosen("2/2", 5), ElementsAre(1, 3));
  EXPECT_THAT(chosen("5/8", 4), ElementsAre());  // an array that is larger than the plan
  for (const char* text : {"0", "4/3", "0/0", "x", "1/", "/2", "-1", "1/2/3", ""})
    EXPECT_THROW(chosen(text, 3), UsageError) << text;
  EXPECT_THROW(chosen("4", 3), UsageError);
}

TEST(FleetShards, AreChosenBySchedulers) {
  EXPECT_THAT(
      chosen_shards(
          automatic({{"SLURM_ARRAY_TASK_ID", "5"}, {"SLURM_ARRAY_TASK_MIN", "1"}, {"SLURM_ARRAY_TASK_COUNT", "10"}}),
          10),
      ElementsAre(4));
  EXPECT_THAT(chosen_shards(automatic({{"SLURM_ARRAY_TASK_ID", "0"}, {"SLURM_ARRAY_TASK_COUNT", "2"}}), 3),
              ElementsAre(0, 2));
  // The tasks 17 and 42, and those from 17 to 18.
  const std::vector<std::pair<std::string, std::string>> list{
      {"SLURM_ARRAY_TASK_ID", "17"}, {"SLURM_ARRAY_TASK_MIN", "17"}, {"SLURM_ARRAY_TASK_COUNT", "2"}};
  const auto up_to = [&list](const std::string& last) {
    std::map<std::string, std::string> variables(list.begin(), list.end());
    variables["SLURM_ARRAY_TASK_MAX"] = last;
    return automatic(variables);
  };
  EXPECT_THROW(up_to("42"), UsageError) << "an array with gaps";
  EXPECT_THAT(chosen_shards(up_to("18"), 3), ElementsAre(0, 2));
  EXPECT_THAT(chosen_shards(automatic({{"AWS_BATCH_JOB_ARRAY_INDEX", "2"}}), 3), ElementsAre(2));
  EXPECT_THAT(chosen_shards(automatic({{"AWS_BATCH_JOB_ARRAY_INDEX", "1"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "2"}}), 4),
              ElementsAre(1, 3));
  const ShardChoice kubernetes = automatic({{"JOB_COMPLETION_INDEX", "7"}});
  EXPECT_EQ(kubernetes.index, 7U);
  EXPECT_EQ(kubernetes.said_by, "JOB_COMPLETION_INDEX=7");
  EXPECT_THROW(automatic({}), UsageError);
  EXPECT_THROW(automatic({{"SLURM_ARRAY_TASK_ID", "x"}}), UsageError);
  EXPECT_THROW(automatic({{"SLURM_ARRAY_TASK_ID", "1"}, {"SLURM_ARRAY_TASK_MIN", "2"}}), UsageError);
}

}  // namespace
}  // namespace gdtslam
