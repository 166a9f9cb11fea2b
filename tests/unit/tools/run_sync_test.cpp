// What run_folder.hpp and docs/formats.md promise of the order of things on the disk: the files of a run are there
// before the old ones go, the old ones are gone before a new one takes its name, and the report is the last to do so.
// Locks are asked for, and who holds one is left alone.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/runs/fleet/record.hpp"
#include "engine/runs/fleet/work_folder.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "support/recorded_calls.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using test::RecordedCalls;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Gt;
using testing::Lt;

class SyncsOfRuns : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(path(name)) << name;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-syncs-" + std::to_string(::getpid()));
};

TEST_F(SyncsOfRuns, ARecordOfAFleetIsOnTheDiskWithItsFolders) {
  UnitRecord record;
  record.plan = "0123456789abcdef";
  record.unit = 12345;
  record.uri = "a.log";
  record.input_sha256 = std::string(64, 'a');
  record.run = std::string(16, '0');
  record.result_sha256 = std::string(64, 'b');
  record.host = "n1";
  record.isa = "avx2";
  record.device = "cpu";
  const RecordedCalls calls(folder_);
  write_record(folder_.string(), record);
  const std::string named = "rename units/012/~ to units/012/012345.json";
  ASSERT_LT(calls.place_of(named), calls.all().size()) << testing::PrintToString(calls.all());
  EXPECT_LT(calls.place_of("sync units/012/~"), calls.place_of(named));
  EXPECT_EQ(calls.place_of("sync units/012"), calls.place_of(named) + 1);
  EXPECT_EQ(calls.all().back(), "sync units");
}

TEST_F(SyncsOfRuns, ARunThatMovesIntoTheAtlasIsOnTheDiskWithItsFolders) {
  write("work/report.json");
  const RecordedCalls calls(folder_);
  move_into_atlas(path("work"), folder_.string(), "abcdef0123456789", path("staging"));
  EXPECT_THAT(calls.all(), ElementsAre("rename work to runs/ab/abcdef0123456789", "sync runs/ab", "sync runs"));
}

// Whoever lives holds a lock on its mark; who does not is gone, and what has no mark belongs to others.
TEST_F(SyncsOfRuns, OnlyAWorkFolderWhoseMarkNobodyLocksIsRemoved) {
  for (const char* name : {"gdtslam-fleet-1-living", "gdtslam-fleet-2-left"})
    write(std::string(name) + "/.gdtslam-fleet");
  write("gdtslam-fleet-3-unmarked/file");
  write("another/.gdtslam-fleet");
  const int living = ::open(path("gdtslam-fleet-1-living/.gdtslam-fleet").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(living, LOCK_EX | LOCK_NB), 0);
  const RecordedCalls calls(folder_);
  {
    const WorkFolder own(folder_.string());
    EXPECT_TRUE(fs::exists(path("gdtslam-fleet-1-living")));
    EXPECT_FALSE(fs::exists(path("gdtslam-fleet-2-left")));
    EXPECT_TRUE(fs::exists(path("gdtslam-fleet-3-unmarked/file")));
    EXPECT_TRUE(fs::exists(path("another/.gdtslam-fleet")));
    const int mark = ::open((own.path() + "/.gdtslam-fleet").c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_EQ(::flock(mark, LOCK_EX | LOCK_NB), -1) << "its own mark is not locked";
    ::close(mark);
  }
  ::close(living);
}

}  // namespace
}  // namespace gdtslam
