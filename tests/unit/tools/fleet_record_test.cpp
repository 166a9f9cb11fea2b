// Records of a fleet's units, their tables, and the hash of all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "engine/runs/fleet/atlas_hash.hpp"
#include "engine/runs/fleet/input.hpp"
#include "engine/runs/fleet/record.hpp"
#include "engine/runs/fleet/state.hpp"
#include "engine/runs/fleet/summary.hpp"
#include "engine/runs/fleet/work_folder.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/transaction/folder_lock.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/fleet/runner.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

const std::string kPlan = "0123456789abcdef";

UnitRecord mapped_record(std::size_t unit) {
  UnitRecord record;
  record.plan = kPlan;
  record.unit = unit;
  record.uri = "/logs/a\tb\n.log";
  record.bytes = 1234;
  record.input_sha256 = std::string(64, 'a');
  record.run = std::string(16, '0');
  record.result_sha256 = std::string(64, 'b');
  record.figures = {350, 2, 116, 30.946, 58.166667, 60.65, 21.15};
  record.cpu_s = 0.1 + 0.2;
  record.wall_s = 1e-9;
  record.host = "n1";
  record.isa = "avx2";
  record.device = "cpu";
  return record;
}

UnitRecord refused_record(std::size_t unit) {
  UnitRecord record = mapped_record(unit);
  record.input_sha256 = std::string(64, 'c');
  record.run = std::string(16, 'f');
  record.result_sha256.clear();
  record.exit_code = 65;
  record.reason = "is \"empty\", or none";
  record.figures = {};
  return record;
}

TEST(FleetRecord, ReadsBackAsItWasWritten) {
  for (const UnitRecord& record : {mapped_record(12345), refused_record(7)})
    EXPECT_EQ(parse_record(record_text(record), "r"), record);
  EXPECT_EQ(record_path(12345), "units/012/012345.json");
  EXPECT_EQ(run_path("abcdef0123456789"), "runs/ab/abcdef0123456789");
}

TEST(FleetRecord, IsNoneWhereItIsTorn) {
  const std::string text = record_text(mapped_record(3));
  for (std::size_t cut = 0; cut + 2 < text.size(); ++cut)
    EXPECT_THROW(parse_record(text.substr(0, cut), "r"), InputError) << cut;
  const auto with = [&text](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  EXPECT_THROW(parse_record(with("\"run\": \"00", "\"run\": \"../"), "r"), InputError);
  EXPECT_THROW(parse_record(with("\"unit\": 3", "\"unit\": -3"), "r"), InputError);
  EXPECT_THROW(parse_record(with("\"exit_code\": 0", "\"exit_code\": 65"), "r"), InputError);
}

// Other bytes, as many and with the old time: who sees them has opened the file.
void replace_unseen(const std::string& file) {
  const auto written = std::filesystem::last_write_time(file);
  const auto bytes = std::filesystem::file_size(file);
  std::ofstream(file) << std::string(bytes, 'x');
  std::filesystem::last_write_time(file, written);
}

TEST(FleetRecord, CountsWhereItLies) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  StoredPlan stored;
  stored.id = kPlan;
  stored.plan.units = {{"/a", 1}, {"/b", 1}, {"/c", 1}, {"/d", 1}};
  stored.plan.shards = {{0, 1, 2, 3}};
  write_record(folder.path(), mapped_record(0));
  write_record(folder.path(), refused_record(1));
  UnitRecord other = mapped_record(2);
  other.plan = std::string(16, '9');
  write_record(folder.path(), other);
  std::ofstream(folder.path() + "/units/000/000003.json") << "{";
  std::ofstream(folder.path() + "/units/000/.000003.json.1-1.tmp") << "{";
  AtlasState state = read_state(folder.path(), stored);
  EXPECT_TRUE(state.records[0] && state.records[1] && !state.records[2] && !state.records[3]);
  ASSERT_EQ(state.damaged.size(), 2U);
  EXPECT_THAT(state.damaged[0], HasSubstr("000002.json: is of another plan"));
  EXPECT_THAT(state.damaged[1], HasSubstr("000003.json:1: is no JSON text"));
  // A table spares reading the records, but says nothing of those that are gone.
  write_shard_table(folder.path(), stored, 0, state);
  std::filesystem::remove(folder.path() + "/units/000/000000.json");
  replace_unseen(folder.path() + "/units/000/000001.json");
  state = read_state(folder.path(), stored);
  EXPECT_TRUE(!state.records[0] && state.records[1]);
  write_record(folder.path(), mapped_record(3));  // a torn one is written anew
  EXPECT_TRUE(read_state(folder.path(), stored).records[3]);
  // The second of two that do the same unit changes nothing.
  UnitRecord second = mapped_record(3);
  second.host = "n2";
  write_record(folder.path(), second);
  EXPECT_EQ(read_record(folder.path(), 3).host, "n1");
}

TEST(FleetTable, ReadsBackAndIsNoneWhereItIsCut) {
  std::vector<UnitRecord> records{mapped_record(1), refused_record(2)};
  const std::string text = records_table(kPlan, records);
  for (UnitRecord& record : records) record.uri = "/logs/a b .log";
  EXPECT_EQ(parse_records_table(text, kPlan), records);
  EXPECT_FALSE(parse_records_table(text, std::string(16, '9')));
  for (std::size_t cut = 0; cut < text.size(); ++cut)
    EXPECT_FALSE(parse_records_table(text.substr(0, cut), kPlan)) << cut;
  EXPECT_FALSE(parse_records_table(text + "x", kPlan));
}

StoredPlan plan_of_one_unit() {
  StoredPlan stored;
  stored.id = kPlan;
  stored.plan.units = {{"/a", 1}};
  stored.plan.shards = {{0}};
  return stored;
}

TEST(FleetTable, CountsForTheRecordThatItWasMadeOf) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const StoredPlan stored = plan_of_one_unit();
  const std::string file = folder.path() + "/" + record_path(0);
  write_record(folder.path(), mapped_record(0));
  const auto written = std::filesystem::last_write_time(file);
  write_shard_table(folder.path(), stored, 0, read_state(folder.path(), stored));
  std::filesystem::remove(file);
  write_record(folder.path(), refused_record(0));
  std::filesystem::last_write_time(file, written);
  EXPECT_FALSE(read_state(folder.path(), stored).records[0]->is_mapped()) << "another size";
  std::filesystem::remove(file);
  UnitRecord other = mapped_record(0);
  other.host = "n2";
  write_record(folder.path(), other);
  std::filesystem::last_write_time(file, written + std::chrono::microseconds(1));
  EXPECT_EQ(read_state(folder.path(), stored).records[0]->host, "n2") << "another time";
}

TEST(FleetTable, IsMadeOfTheRecordThatLiesThere) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const StoredPlan stored = plan_of_one_unit();
  write_record(folder.path(), mapped_record(0));
  AtlasState state;
  state.records = {mapped_record(0)};
  state.records[0]->host = "n2";  // which was second
  write_shard_table(folder.path(), stored, 0, state);
  replace_unseen(folder.path() + "/" + record_path(0));
  ASSERT_TRUE(read_state(folder.path(), stored).records[0]) << "the table does not count";
  EXPECT_EQ(read_state(folder.path(), stored).records[0]->host, "n1");
}

TEST(FleetTable, IsNoneWhereItIsNoUtf8) {  // JSON and the page of an atlas could not hold its words
  UnitRecord record = mapped_record(1);
  record.host = "B\xC3\xBCro";
  EXPECT_TRUE(parse_records_table(records_table(kPlan, {record}), kPlan));
  record.host = "B\xFCro";
  EXPECT_FALSE(parse_records_table(records_table(kPlan, {record}), kPlan));
}

TEST(FleetHash, DependsOnTheResultsAlone) {
  AtlasState state;
  state.records = {refused_record(0), mapped_record(1)};
  // By Python's hashlib, of "0000000000000000 aa.. mapped bb..\nffffffffffffffff cc.. refused \n".
  const std::string expected = "8f24c844d8669da89157be27dae4e6de44b5519f13d8f7837a73efad403c62b6";
  EXPECT_EQ(atlas_sha256_of(state), expected);
  std::swap(state.records[0], state.records[1]);
  state.records[0]->uri = "/elsewhere";
  state.records[0]->host = "n9";
  state.records[0]->isa = "baseline";
  state.records[1]->reason = "named in other words";
  EXPECT_EQ(atlas_sha256_of(state), expected);
  state.records[0]->result_sha256.back() = 'c';
  EXPECT_NE(atlas_sha256_of(state), expected);
}

TEST(FleetSummary, CountsReasonsWithoutTheirNumbers) {
  EXPECT_EQ(kind_of_reason("line 12: has 3.25 m, not 1e5"), "line N: has N m, not NeN");
  EXPECT_EQ(kind_of_reason("ends."), "ends.");
  StoredPlan stored;
  stored.plan.units = {{"/a,b", 1}, {"/c", 1}, {"/d", 1}};
  stored.plan.shards = {{0, 1}, {2}};
  AtlasState state;
  state.records = {refused_record(0), mapped_record(1), std::nullopt};
  const AtlasSummary summary = summary_of(stored, state);
  EXPECT_EQ(summary.counts.missing(), 1U);
  EXPECT_EQ(summary.shards[0].missing(), 0U);
  EXPECT_EQ(summary.shards[1].missing(), 1U);
  const std::string csv = summary_csv(stored, state);
  EXPECT_THAT(csv, HasSubstr("\n0,\"/a,b\",refused,65,\"is \"\"empty\"\", or none\","));
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  EXPECT_EQ(commas(csv.substr(0, csv.find('\n'))), commas(csv.substr(csv.rfind("\n2,") + 1)));
}

TEST(FleetInput, IsHashedAndNamed) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  std::ofstream(folder.path() + "/abc.log") << "abc";
  FleetPlan plan;
  // The example of FIPS 180.
  const std::string abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  const UnitInput file = unit_input(plan, {folder.path() + "/abc.log", 3}, folder.path(), {});
  EXPECT_EQ(file.sha256, abc);
  EXPECT_EQ(file.bytes, 3U);
  plan.get = "printf abc # {}";
  const UnitInput fetched = unit_input(plan, {"s3://bucket/it's.log?x=1", 0}, folder.path(), {});
  EXPECT_EQ(fetched.sha256, abc);
  EXPECT_EQ(fetched.path, folder.path() + "/it_s.log");
  EXPECT_TRUE(std::filesystem::exists(fetched.path));
  const FleetPlan same;
  EXPECT_EQ(unit_name(same, file), unit_name(plan, fetched));  // where a log comes from is no part of its name
  plan.config = "x";
  EXPECT_NE(unit_name(same, file), unit_name(plan, file));
  plan = {};
  plan.program.version = "2";
  EXPECT_NE(unit_name(same, file), unit_name(plan, file));
  UnitInput with_linkage = file;
  with_linkage.linkage_sha256 = abc;
  EXPECT_NE(unit_name(same, file), unit_name(same, with_linkage));
}

TEST(FleetInput, ThatCannotBeFetchedIsTheMachinesFault) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  FleetPlan plan;
  plan.get = "printf abc; exit 3 # {}";
  try {
    unit_input(plan, {"s3://b/a.log", 0}, folder.path(), {});
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ended with code 3"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/a.log"));
  // The command itself and not a shell that waits for it: what goes on would hold the streams of this test.
  plan.get = "exec sleep 60 # {}";
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(unit_input(plan, {"s3://b/a.log", 0}, folder.path(), [] { return true; }), Error);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30)) << "nobody waits for its end";
  EXPECT_EQ(get_command("cat {} -", "a'b; rm x"), "cat 'a'\\''b; rm x' -");
  EXPECT_THROW((void)get_command("cat", "s3://a"), UsageError);
  for (const char* quoted :
       {"cat '{}'", "cat \"{}\"", "sh -c 'cat {}'", "cat \\{}", "cat `echo {}`", "a 'b' \"c'{}\""}) {
    EXPECT_THROW((void)get_command(quoted, "s3://a;touch x"), UsageError) << quoted;
  }
  EXPECT_EQ(get_command("f 'a\"b' \"c'd\" {} -", "s3://a"), "f 'a\"b' \"c'd\" 's3://a' -");
  EXPECT_EQ(get_command("f {} || g {}", "s3://{}"), "f 's3://{}' || g 's3://{}'");
  EXPECT_THROW((void)get_command("f {} || g '{}'", "s3://a;touch x"), UsageError);
}

// Whether the process goes on; one that has ended and that nobody has waited for does not.
bool goes_on(const std::string& process) {
  std::ifstream status("/proc/" + process + "/stat");
  std::string name;
  std::string state;
  return status >> name >> name >> state && state != "Z";
}

TEST(FleetInput, ThatIsGivenUpLeavesNoProcessBehind) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string file = folder.path() + "/process";
  FleetPlan plan;
  plan.get = "(sleep 60 & echo $! > " + file + ".new; mv " + file + ".new " + file + "; wait); true # {}";
  const auto is_started = [&] { return std::filesystem::exists(file); };
  EXPECT_THROW(unit_input(plan, {"s3://b/a.log", 0}, folder.path(), is_started), Error);
  std::string process;
  std::ifstream(file) >> process;
  ASSERT_NE(process, "");
  for (int k = 0; k < 500 && goes_on(process); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(goes_on(process)) << process;
}

TEST(FleetWorkFolder, RemovesWhatIsLeftAndNothingElse) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string left = folder.path() + "/gdtslam-fleet-1-abcdef";
  const std::string unmarked = folder.path() + "/gdtslam-fleet-2-abcdef";
  const std::string empty = folder.path() + "/gdtslam-fleet-31-aB3dEf";
  const std::string foreign = folder.path() + "/other";
  for (const std::string& path : {left, unmarked, empty, foreign}) std::filesystem::create_directory(path);
  for (const std::string& path : {left, foreign}) std::ofstream(path + "/.gdtslam-fleet") << "mark";
  std::ofstream(unmarked + "/notes") << "mine";
  std::string gone;
  {
    const WorkFolder first(folder.path());
    const WorkFolder second(folder.path());
    EXPECT_TRUE(std::filesystem::exists(first.path()));
    EXPECT_NE(first.path(), second.path());
    gone = first.path();
  }
  EXPECT_FALSE(std::filesystem::exists(gone));
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(unmarked + "/notes"));
  EXPECT_FALSE(std::filesystem::exists(empty)) << "its process was killed before it was marked";
  EXPECT_TRUE(std::filesystem::exists(foreign));
}

TEST(FleetWorkFolder, LeavesEmptyFoldersOfOtherNames) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  for (const char* name :
       {"gdtslam-fleet-", "gdtslam-fleet-results", "gdtslam-fleet-7", "gdtslam-fleet--abcdef", "gdtslam-fleet-7-abcde",
        "gdtslam-fleet-7-abcdefg", "gdtslam-fleet-7-abc-ef", "gdtslam-fleet-7abcdef", "gdtslam-7-abcdef", "7-abcdef"})
    std::filesystem::create_directory(folder.path() + "/" + name);
  { const WorkFolder work(folder.path()); }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 10);
}

// Each removes what it takes for left, an empty folder too: none of them loses its own.
TEST(FleetWorkFolder, ManyAtOnceKeepTheirs) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  std::atomic<int> lost = 0;
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 4; ++k) {
      threads.emplace_back([&] {
        for (int round = 0; round < 200; ++round) {
          const WorkFolder work(folder.path());
          if (!std::filesystem::exists(work.path() + "/.gdtslam-fleet")) ++lost;
        }
      });
    }
  }
  EXPECT_EQ(lost, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(FleetWorkFolder, GivesARunItsNameOnce) {
  const TemporaryFolder folder("gdtslam-fleet-test");
  const std::string atlas = folder.path() + "/atlas";
  for (const char* text : {"first", "second"}) {
    const std::string run = folder.path() + "/" + text;
    std::filesystem::create_directory(run);
    std::ofstream(run + "/report.json") << text;
    move_into_atlas(run, atlas, "abcdef0123456789", folder.path());
  }
  std::string text;
  std::ifstream(atlas + "/runs/ab/abcdef0123456789/report.json") >> text;
  EXPECT_EQ(text, "first");
}

TEST(FleetRunner, AllowsSoManyRefused) {
  EXPECT_EQ(parse_most_refused("--max-failed", "2%").of(200), 4U);
  EXPECT_EQ(parse_most_refused("--max-failed", "2 %").of(5), 1U);
  EXPECT_EQ(parse_most_refused("--max-failed", "28%").of(25), 7U);
  EXPECT_EQ(parse_most_refused("--max-failed", "0.7%").of(1000), 7U);
  EXPECT_EQ(parse_most_refused("--max-failed", "100%").of(500'000), 500'000U);
  EXPECT_EQ(parse_most_refused("--max-failed", "0%").of(5), 0U);
  EXPECT_EQ(parse_most_refused("--max-failed", "7").of(5), 7U);
  for (const char* text : {"", "x", "-1", "1.5", "101%", "2percent", "nan"})
    EXPECT_THROW(parse_most_refused("--max-failed", text), UsageError) << text;
}

}  // namespace
}  // namespace gdtslam
