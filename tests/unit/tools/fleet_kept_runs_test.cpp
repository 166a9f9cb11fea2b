// Runs of an atlas that are gone, damaged or of something else than the plan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/fleet/kept_run.hpp"
#include "engine/runs/fleet/state.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

UnitRecord record_of_run(std::size_t unit, char run) {
  UnitRecord record;
  record.plan = std::string(16, 'a');
  record.unit = unit;
  record.host = "n1";
  record.input_sha256 = std::string(64, run);
  record.run = std::string(16, run);
  record.result_sha256 = std::string(64, run);
  return record;
}

class FleetKeptRuns : public testing::Test {
 protected:
  FleetKeptRuns() {
    stored_.id = std::string(16, 'a');
    stored_.plan.units = {{"/a", 1}, {"/b", 1}, {"/c", 1}};
    stored_.plan.shards = {{0, 1, 2}};
  }
  [[nodiscard]] std::string atlas() const { return folder_.path(); }
  void put_report(char run) const {
    const std::string place = atlas() + "/" + run_path(std::string(16, run));
    fs::create_directories(place);
    std::ofstream(place + "/report.json") << "{}";
  }
  [[nodiscard]] AtlasState kept() const { return read_state_of_kept_runs(atlas(), stored_); }

  const TemporaryFolder folder_{"gdtslam-fleet-test"};
  StoredPlan stored_;
};

TEST_F(FleetKeptRuns, ThatAreGoneAreToDo) {
  UnitRecord refused = record_of_run(2, 'c');
  refused.exit_code = 65;
  refused.result_sha256.clear();
  write_record(atlas(), record_of_run(0, '1'));
  write_record(atlas(), record_of_run(1, '2'));
  write_record(atlas(), refused);
  for (const char run : {'1', '2'}) put_report(run);
  EXPECT_THAT(kept().lost, SizeIs(0));
  write_shard_table(atlas(), stored_, 0, kept());
  for (const bool has_table : {true, false}) {
    fs::remove(atlas() + "/" + run_path(std::string(16, '2')) + "/report.json");
    if (!has_table) fs::remove_all(atlas() + "/shards");
    const AtlasState state = kept();
    EXPECT_TRUE(state.records[0] && !state.records[1] && state.records[2]) << "a table: " << has_table;
    ASSERT_THAT(state.lost, SizeIs(1));
    EXPECT_EQ(state.lost[0].run, std::string(16, '2'));
  }
  EXPECT_TRUE(read_state(atlas(), stored_).records[1]) << "the record is there";
}

TEST_F(FleetKeptRuns, ThatAreMappedAgainKeepTheirRecordUnlessTheLogIsAnother) {
  write_record(atlas(), record_of_run(0, '1'));
  UnitRecord again = record_of_run(0, '1');
  again.host = "n2";
  write_record(atlas(), again);
  EXPECT_EQ(read_record(atlas(), 0).host, "n1");
  UnitRecord of_another_log = record_of_run(0, '3');
  put_report('1');
  write_record(atlas(), of_another_log);
  EXPECT_EQ(read_record(atlas(), 0).run, std::string(16, '1')) << "the first of two counts";
  fs::remove_all(atlas() + "/runs");
  write_record(atlas(), of_another_log);
  EXPECT_EQ(read_record(atlas(), 0).run, std::string(16, '3')) << "a record of a run that nobody has";
}

TEST_F(FleetKeptRuns, AreThereWithTheirReport) {
  const std::string run = atlas() + "/run";
  EXPECT_FALSE(is_run_there(run));
  fs::create_directory(run);
  EXPECT_FALSE(is_run_there(run)) << "an empty folder, which a run takes the place of";
  std::ofstream(run + "/gdt.png") << "x";
  EXPECT_THROW((void)is_run_there(run), FileError);
  std::ofstream(run + "/report.json") << "{}";
  EXPECT_TRUE(is_run_there(run));
}

TEST_F(FleetKeptRuns, BehindWhatCannotBeLookedIntoAreNotTakenForGone) {
  const std::string name(16, '1');
  const std::string run = atlas() + "/" + run_path(name);
  write_record(atlas(), record_of_run(0, '1'));
  fs::create_directories(fs::path(run).parent_path());
  EXPECT_FALSE(has_report(atlas(), name));
  const auto expect_fault = [&](const char* what) {
    EXPECT_THROW((void)is_run_there(run), FileError) << what;
    EXPECT_THROW((void)has_report(atlas(), name), FileError) << what;
    EXPECT_THROW((void)kept(), FileError) << what;
  };
  for (const std::string& target : {std::string("nowhere"), run}) {
    fs::create_symlink(target, run);
    expect_fault("a link to nothing, and one to itself, which is an error as of a folder that may not be read");
    fs::remove(run);
  }
  fs::create_directory(run);
  fs::create_symlink("nowhere", run + "/report.json");
  expect_fault("the report");
  fs::remove_all(run);
  fs::create_directory(atlas() + "/empty");
  fs::create_directory_symlink(atlas() + "/empty", run);
  EXPECT_FALSE(has_report(atlas(), name));
  EXPECT_THROW((void)is_run_there(run), FileError) << "no run takes the place of a link";
  fs::remove_all(atlas() + "/runs");
  fs::create_symlink("nowhere", atlas() + "/runs");
  expect_fault("the disk of all runs");
}

/// A run folder of two files as a run writes it.
class FleetRunFolder : public testing::Test {
 protected:
  FleetRunFolder() {
    std::ofstream(path("config.yaml")) << config_text(option_table(settings_));
    std::ofstream(path("gdt.png")) << "one";
    tell_of_files();
  }
  void tell_of_files() const {
    // printf one | sha256sum
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    files.push_back({"gdt.png", 3, "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed"});
    for (const char* name : {"config.yaml", "edits.json"}) {
      if (!fs::exists(path(name))) continue;
      const HashedBytes hashed = sha256_of_file(path(name));
      files.push_back({name, hashed.bytes, hashed.sha256});
    }
    write_json(path("report.json"), {{"format", 1}, {"map_sha256", ""}, {"files", files}});
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  [[nodiscard]] std::string fault() const {
    try {
      require_run_of_plan(folder_.path(), settings_);
      return {};
    } catch (const FileError& error) {
      return error.what();
    }
  }

  const TemporaryFolder folder_{"gdtslam-fleet-test"};
  Settings settings_;
};

TEST_F(FleetRunFolder, IsWholeOrTheFileIsNamed) {
  EXPECT_EQ(fault(), "");
  const auto is_advice_for_an_atlas =
      AllOf(HasSubstr("; remove that folder and run its shard again"), Not(HasSubstr("gdtslam map")));
  std::ofstream(path("gdt.png")) << "onE";
  EXPECT_THAT(fault(),
              AllOf(HasSubstr("is damaged: " + path("gdt.png") + ": has another SHA-256"), is_advice_for_an_atlas));
  std::ofstream(path("gdt.png")) << "on";
  EXPECT_THAT(fault(), AllOf(HasSubstr("gdt.png: has 2 bytes"), is_advice_for_an_atlas));
  fs::remove(path("gdt.png"));
  EXPECT_THAT(fault(), AllOf(HasSubstr("gdt.png: is missing"), is_advice_for_an_atlas));
}

TEST_F(FleetRunFolder, IsOfThePlansSettingsAndNotEdited) {
  settings_.mapper.map.resolution_m *= 2.0;
  EXPECT_THAT(fault(), HasSubstr("is a run of other settings than the plan's, or was edited; remove that folder"));
  std::ofstream(path("config.yaml")) << config_text(option_table(settings_));
  tell_of_files();
  EXPECT_EQ(fault(), "");
  std::ofstream(path("edits.json")) << "{}";
  tell_of_files();
  EXPECT_THAT(fault(), HasSubstr("or was edited"));
}

}  // namespace
}  // namespace gdtslam
