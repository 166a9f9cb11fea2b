// Which files are those of a run, whatever path leads to them.
#include "engine/runs/folder/run_folder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

class FilesOfRunsTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::canonical(fs::temp_directory_path()) / ("gdtslam-files-of-runs-" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "run");
    std::ofstream(path("run/log-1.jsonl.zst")) << "a log";
    fs::create_symlink("run", path("to_run"));
    fs::create_symlink("run/log-1.jsonl.zst", path("to_log"));
    fs::create_symlink("run/log-2.jsonl.zst", path("to_nothing"));
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

TEST_F(FilesOfRunsTest, APlaceIsTheSameByEveryPath) {
  for (const char* name : {"run/log-1.jsonl.zst", "to_run/log-1.jsonl.zst", "to_log", "run/../run/./log-1.jsonl.zst"}) {
    EXPECT_EQ(place_of_file(path(name)), folder_ / "run/log-1.jsonl.zst") << name;
  }
  for (const char* name :
       {"run/log-2.jsonl.zst", "to_run/log-2.jsonl.zst", "to_nothing", "nowhere/../run/log-2.jsonl.zst"}) {
    EXPECT_EQ(place_of_file(path(name)), folder_ / "run/log-2.jsonl.zst") << name;
  }
  EXPECT_EQ(place_of_file(path("run/")), folder_ / "run");
  EXPECT_EQ(place_of_file(path("none/")), folder_ / "none");
}

TEST_F(FilesOfRunsTest, FilesOfARunAreThoseOfItsNamesThereOrNot) {
  for (const char* name : {"run/log-1.jsonl.zst", "to_log", "to_nothing", "run/report.json", "run/tiles/0/map.pgm"}) {
    EXPECT_TRUE(is_run_file_in(path("run"), path(name))) << name;
    EXPECT_TRUE(is_run_file_in(path("to_run/"), path(name))) << name;
  }
  for (const char* name : {"run/view.png", "log-1.jsonl.zst", "run/views/report.json", "run", "other/report.json"}) {
    EXPECT_FALSE(is_run_file_in(path("run"), path(name))) << name;
  }
}

TEST_F(FilesOfRunsTest, AFileLiesInAFolderByEveryPath) {
  for (const char* name : {"run/view.png", "to_log", "to_run/views/a.png", "run/../run/b"}) {
    EXPECT_TRUE(lies_in(path("to_run"), path(name))) << name;
  }
  for (const char* name : {"run", "other", "run/../other", "runs/a"})
    EXPECT_FALSE(lies_in(path("run"), path(name))) << name;
}

}  // namespace
}  // namespace gdtslam
