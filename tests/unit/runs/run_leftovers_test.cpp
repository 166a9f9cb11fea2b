// What killed processes left in a folder that is written to: it may be all that there is of a drive's log, and goes
// once a run has taken its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/edits/edit_run.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

void put_text(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

// Of a process of a number that none has.
fs::path staging_of_nobody(const std::string& folder) {
  return fs::path(folder) / (std::string(kStagingPrefix) + "1999999999");
}

// As of a drive that was killed, which had all of that run's log.
void put_recording(const std::string& folder, const std::string& run) {
  const fs::path staging = staging_of_nobody(folder);
  fs::create_directories(staging);
  for (const char* name : {"continue.json", "log-1.copy"}) fs::copy_file(fs::path(run) / name, staging / name);
}

bool has_recording(const std::string& folder) {
  const fs::path found = unfinished_run_in(folder, "continue.json").folder;
  return !found.empty() && fs::exists(found / "log-1.copy");
}

/// A run of the first scans of the drive, and a folder that a killed drive has left.
class RunLeftovers : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<Pose2> drive = test::ring_drive();
    test::write_ring_log(folder_.path("a.log"), {drive.begin(), drive.begin() + 30}, 5);
    static_cast<void>(map_logs(test::ring_request(folder_.path("a.log"), run_), *cpu_));
    put_recording(left_, run_);
  }
  /// The run, mapped once more into that folder.
  [[nodiscard]] MapRequest mapped_again(const std::string& folder) const {
    MapRequest request = test::ring_request("", folder);
    request.logs.clear();
    request.continued = run_;
    return request;
  }

  const test::RunsFolder folder_{"leftovers"};
  const std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
  const std::string run_ = folder_.path("run");
  const std::string left_ = folder_.path("left");
};

TEST_F(RunLeftovers, StayUntilACommitSucceeds) {
  { const RunFolder folder(left_); }
  EXPECT_TRUE(has_recording(left_));
  {
    RunFolder folder(left_);
    folder.staged("notes.txt");  // never written: its rename fails
    EXPECT_THROW(folder.commit(), FileError);
  }
  EXPECT_TRUE(has_recording(left_));
  RunFolder(left_).commit(RunFolder::Leftovers::kKept);
  EXPECT_TRUE(has_recording(left_));
  RunFolder(left_).commit();
  EXPECT_FALSE(has_recording(left_));
}

// A process of a container may have the number of one that was killed, and another one's leftover to go on with.
TEST_F(RunLeftovers, OfAProcessOfTheSameNumberAreSetAside) {
  const fs::path own = fs::path(left_) / (std::string(kStagingPrefix) + std::to_string(::getpid()));
  fs::rename(staging_of_nobody(left_), own);
  { const RunFolder folder(left_); }
  EXPECT_TRUE(has_recording(left_));
  const fs::path aside = unfinished_run_in(left_, "continue.json").folder;
  put_text(own / "trajectory.tum", "of an edit that was killed");
  const RunFolder folder(left_, aside);
  EXPECT_TRUE(fs::exists(folder.staged_path("log-1.copy")));
}

TEST_F(RunLeftovers, OfAProcessOfTheSameNumberAreGoneOnWithHoweverTheirFolderIsSpelt) {
  const fs::path own = fs::path(left_) / (std::string(kStagingPrefix) + std::to_string(::getpid()));
  fs::rename(staging_of_nobody(left_), own);
  const std::string link = folder_.path("link");
  fs::create_directory_symlink(left_, link);
  for (const std::string& spelt : {left_, folder_.path("./left"), left_ + "/", link}) {
    const RunFolder folder(spelt, own);
    EXPECT_TRUE(fs::exists(folder.staged_path("log-1.copy"))) << spelt;
  }
}

TEST_F(RunLeftovers, StayWhereAnEditFails) {
  EditRequest request;
  request.run = run_;
  request.folder = left_;
  request.with_pictures = false;
  request.crop = RegionBounds{{900.0, 900.0}, {901.0, 901.0}};
  EXPECT_THROW(static_cast<void>(edit_run(request)), InputError);
  EXPECT_TRUE(has_recording(left_));
  request.crop = RegionBounds{{-2.0, -3.0}, {6.0, 1.0}};
  static_cast<void>(edit_run(request));
  EXPECT_FALSE(has_recording(left_)) << "a run has taken its place";
}

TEST_F(RunLeftovers, StayWhereAnotherRunThatIsGoneOnWithFails) {
  MapRequest request = mapped_again(left_);
  request.progress = [&](std::uint64_t, double) { put_text(left_ + "/map.yaml", "mine"); };
  EXPECT_THROW(static_cast<void>(map_logs(request, *cpu_)), UsageError);
  EXPECT_TRUE(fs::exists(staging_of_nobody(left_) / "log-1.copy"));
}

TEST_F(RunLeftovers, AreGoneOnWithInPlaceOfFilesOfOthersWhereTheseAreReplaced) {
  for (const std::string& folder : {folder_.path("other"), left_}) {
    put_text(folder + "/map.yaml", "mine");
    MapRequest request = mapped_again(folder);
    if (folder == left_) request.continued = left_;
    EXPECT_THROW(static_cast<void>(map_logs(request, *cpu_)), UsageError);
    request.replace_foreign_files = true;
    static_cast<void>(map_logs(request, *cpu_));
    EXPECT_EQ(RunReader(folder).summary().scans, 30U);
    EXPECT_NE(test::text_of_file(folder + "/map.yaml"), "mine");
  }
}

// Before anything is mapped: the copy of the log that comes behind, whose name nobody gave.
TEST_F(RunLeftovers, ACopyOfSomebodyElseIsSeenBeforeTheRunGoesOn) {
  const std::vector<Pose2> drive = test::ring_drive();
  test::write_ring_log(folder_.path("b.log"), {drive.begin() + 30, drive.begin() + 50}, 6);
  put_text(folder_.path("other/log-2.copy"), "mine");
  MapRequest request = mapped_again(folder_.path("other"));
  request.logs = {folder_.path("b.log")};
  std::vector<std::uint64_t> scans;
  request.progress = [&](std::uint64_t done, double) { scans.push_back(done); };
  EXPECT_THROW(static_cast<void>(map_logs(request, *cpu_)), UsageError);
  EXPECT_THAT(scans, IsEmpty());
  EXPECT_EQ(test::text_of_file(folder_.path("other/log-2.copy")), "mine");
}

TEST_F(RunLeftovers, AFileOfTheUsersCalledOldIsCopiedAndNoSignOfACommit) {
  put_text(run_ + "/old", "mine");
  EditRequest request;
  request.run = run_;
  request.folder = folder_.path("edited");
  request.with_pictures = false;
  request.crop = RegionBounds{{-2.0, -3.0}, {6.0, 1.0}};
  for (int times = 0; times < 2; ++times) static_cast<void>(edit_run(request));
  EXPECT_EQ(test::text_of_file(request.folder + "/old"), "mine");
  const std::string folder = folder_.path("killed");
  put_text(folder + "/map.yaml", "mine");
  put_text(staging_of_nobody(folder) / "old", "mine");
  EXPECT_THROW(require_no_foreign_files(folder), UsageError);
  EXPECT_FALSE(unfinished_run_in(folder, "report.json").is_of_a_commit);
}

// The second name is that of version 0.1.0.
TEST(RunLeftoversOfACommit, TellThatTheFilesBesideThemAreOfARun) {
  const test::RunsFolder folder("of-a-commit");
  for (const char* name : {".old", "old"}) {
    const std::string killed = folder.path(std::string("killed-") + name);
    put_text(killed + "/map.yaml", "of a run");
    fs::create_directories(staging_of_nobody(killed) / name);
    EXPECT_NO_THROW(require_no_foreign_files(killed)) << name;
    EXPECT_TRUE(unfinished_run_in(killed, "report.json").is_of_a_commit) << name;
  }
}

}  // namespace
}  // namespace gdtslam
