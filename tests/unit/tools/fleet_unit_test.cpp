// A unit of a fleet whose files are changed while it is mapped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/runs/fleet/input.hpp"
#include "engine/runs/fleet/state.hpp"
#include "engine/runs/fleet/unit.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

void append_to(const std::string& file, const char* text) { std::ofstream(file, std::ios::app) << text; }

class FleetUnitWork : public testing::Test {
 protected:
  FleetUnitWork() {
    append_to(log_, "# no scan\n");
    stored_.id = std::string(16, 'a');
    stored_.plan.units = {{log_, 0}};
    stored_.plan.shards = {{0}};
  }
  [[nodiscard]] UnitWork the_unit() const {
    return {.stored = stored_,
            .unit = 0,
            .atlas = atlas_,
            .settings = {},
            .folder = folder_.path() + "/work",
            .staging = {},
            .place = {},
            .map = {}};
  }
  /// What is said of the unit where this happens while it is mapped; empty where it is done.
  std::string fault_after(
      const std::function<void()>& change,
      const std::function<void(const MapRequest&)>& look = [](const MapRequest&) {}) {
    UnitWork work = the_unit();
    work.map = [&](const MapRequest& request) -> MapResult {
      look(request);
      change();
      throw InputError("has no scan");
    };
    try {
      (void)do_unit(work);
      return {};
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::kInputOutput);
      return error.what();
    }
  }
  /// What is said of it where its log cannot be had; empty where the machine is to blame for something else.
  std::string reason_of_lost_log() {
    try {
      (void)do_unit(the_unit());
      ADD_FAILURE() << "is done";
    } catch (const LogUnavailable& error) {
      return error.what();
    } catch (const FileError&) {
    }
    return {};
  }
  [[nodiscard]] bool is_done() const { return units_with_record(atlas_, 1).front(); }

  const TemporaryFolder folder_{"gdtslam-fleet-test"};
  const std::string log_ = folder_.path() + "/a.log";
  const std::string atlas_ = folder_.path() + "/atlas";
  StoredPlan stored_;
};

TEST_F(FleetUnitWork, IsDoneWhereItsLogStays) {
  EXPECT_THAT(fault_after([] {}), IsEmpty());
  EXPECT_TRUE(is_done());
}

TEST_F(FleetUnitWork, LeavesNoRecordWhereItsLogGrows) {
  EXPECT_EQ(fault_after([&] { append_to(log_, "FLASER 0\n"); }),
            log_ + ": was changed while it was mapped; run the command again");
  EXPECT_FALSE(is_done());
}

// A robot that still writes its logs tells nothing of those that are whole.
TEST_F(FleetUnitWork, IsSaidToHaveLostItsLogWhereThatGrows) {
  UnitWork work = the_unit();
  work.map = [&](const MapRequest&) -> MapResult {
    append_to(log_, "FLASER 0\n");
    throw InputError("has no scan");
  };
  EXPECT_THROW((void)do_unit(work), LogUnavailable);
}

TEST_F(FleetUnitWork, LeavesNoRecordWhereItsLogIsReplaced) {
  EXPECT_THAT(fault_after([&] {
                append_to(log_ + ".new", "# no scan\n");
                std::filesystem::rename(log_ + ".new", log_);
              }),
              HasSubstr("was changed"));
  EXPECT_FALSE(is_done());
}

TEST_F(FleetUnitWork, LeavesNoRecordWhereALinkageComes) {
  const std::string linkage = folder_.path() + "/a.linkage.yaml";
  EXPECT_THAT(fault_after([&] { append_to(linkage, "gdtslam_linkage: 1\n"); }), HasSubstr(linkage + ": was changed"));
  EXPECT_FALSE(is_done());
  std::filesystem::remove(linkage);
  stored_.plan.linkage = "one for all";
  EXPECT_THAT(fault_after([&] { append_to(linkage, "gdtslam_linkage: 1\n"); }), IsEmpty());
}

TEST_F(FleetUnitWork, LeavesNoRecordWhereAFileOfItsBagIsChanged) {
  const std::string bag = folder_.path() + "/bag";
  std::filesystem::create_directory(bag);
  for (const char* name : {"/metadata.yaml", "/bag_0.mcap", "/bag_1.mcap"}) append_to(bag + name, "x");
  stored_.plan.units = {{bag, 0}};
  EXPECT_THAT(fault_after([&] { append_to(bag + "/bag_1.mcap", "x"); }), HasSubstr("bag_1.mcap: was changed"));
  EXPECT_THAT(fault_after([&] { append_to(bag + "/bag_2.mcap", "x"); }), HasSubstr(bag + ": was changed"));
  EXPECT_FALSE(is_done());
}

// What is in the work folder besides the log has names, and an URI may end in any of them.
TEST_F(FleetUnitWork, FetchesALogWhateverItsName) {
  stored_.plan.get = "printf 'fetched' # {}";
  stored_.plan.linkage = "gdtslam_linkage: 1\n";
  for (const char* name : {"run", "linkage.yaml", "log"}) {
    std::filesystem::remove_all(folder_.path() + "/work");
    std::filesystem::remove_all(atlas_);
    stored_.plan.units = {{std::string("x://robot/") + name, 0}};
    std::string log;
    std::string linkage;
    bool is_run_free = false;
    EXPECT_THAT(fault_after([] {},
                            [&](const MapRequest& request) {
                              std::getline(std::ifstream(request.logs.front()), log);
                              std::getline(std::ifstream(request.linkage), linkage);
                              is_run_free = !std::filesystem::exists(request.folder);
                            }),
                IsEmpty());
    EXPECT_EQ(log, "fetched") << name;
    EXPECT_EQ(linkage, "gdtslam_linkage: 1") << name;
    EXPECT_TRUE(is_run_free) << name;
  }
}

TEST_F(FleetUnitWork, StaysToDoWhereSomethingElseIsInThePlaceOfItsLog) {
  std::filesystem::remove(log_);
  std::filesystem::create_directory(log_);
  EXPECT_EQ(fault_after([] {}), log_ + ": is a folder without metadata.yaml: no log, and no ROS 2 bag");
  stored_.plan.units = {{"/dev/zero", 0}};
  EXPECT_EQ(fault_after([] {}), "/dev/zero: is no plain file");
  EXPECT_EQ(reason_of_lost_log(), "/dev/zero: is no plain file");
  EXPECT_FALSE(is_done());
}

TEST_F(FleetUnitWork, StaysToDoWhereItsLogIsGone) {
  std::filesystem::remove(log_);
  EXPECT_THAT(reason_of_lost_log(), HasSubstr(log_ + ": "));
  stored_.plan.units = {{"x://robot/a.log", 0}};
  stored_.plan.get = "printf abc; exit 3 # {}";
  EXPECT_THAT(reason_of_lost_log(), HasSubstr("ended with code 3"));
  EXPECT_FALSE(is_done());
}

// A work disk fails all logs alike, which tells nothing of this one.
TEST_F(FleetUnitWork, IsNotSaidToHaveLostItsLogWhereTheCopyCannotBeWritten) {
  namespace fs = std::filesystem;
  const std::string work = folder_.path() + "/work";
  const std::string copy = work + "/log/a.log";
  stored_.plan.units = {{"x://robot/a.log", 0}};
  stored_.plan.get = "printf abc # {}";
  const std::vector<std::pair<const char*, std::function<void()>>> faults{
      {"No space left", [&] { fs::create_symlink("/dev/full", copy); }},
      {"a.log", [&] { fs::create_directory(copy); }},
      {"work/log", [&] { fs::remove(work + "/log"), append_to(work + "/log", "no folder"); }}};
  for (const auto& [words, plant] : faults) {
    fs::remove_all(work);
    fs::create_directories(work + "/log");
    plant();
    EXPECT_THAT(fault_after([] {}), HasSubstr(words));
    EXPECT_THAT(reason_of_lost_log(), IsEmpty()) << words;
  }
  EXPECT_FALSE(is_done());
}

TEST_F(FleetUnitWork, IsGivenUpWhateverItsCommandDoes) {
  const std::string begun = folder_.path() + "/begun";
  for (const char* command :
       {"exec >&-; sleep 0.3; touch {}; exec sleep 60", "trap '' TERM; touch {}; sleep 60; sleep 60"}) {
    std::filesystem::remove(begun);
    std::string get = command;
    stored_.plan.get = get.replace(get.find("{}"), 2, begun) + " # {}";
    const auto begin = std::chrono::steady_clock::now();
    try {
      (void)unit_input(stored_.plan, {"x://robot/a.log", 0}, folder_.path(),
                       [&begun] { return std::filesystem::exists(begun); });
      ADD_FAILURE() << command;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30)) << command;
  }
}

TEST_F(FleetUnitWork, IsGivenUpWhileItsLogIsHashed) {
  const std::string bag = folder_.path() + "/bag";
  std::filesystem::create_directory(bag);
  append_to(bag + "/metadata.yaml", "x");
  for (const std::string& log : {log_, bag}) {
    int asked = 0;
    try {
      (void)unit_input(stored_.plan, {log, 0}, folder_.path(), [&asked] { return ++asked > 0; });
      ADD_FAILURE() << log;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::kInterrupted);
    }
  }
}

}  // namespace
}  // namespace gdtslam
