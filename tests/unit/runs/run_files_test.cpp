// The files of a run against what its report tells of them, and one writer at a time.
#include "engine/runs/folder/run_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    write_run("one", "two");
  }
  void TearDown() override { fs::remove_all(folder_.parent_path()); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  // As a run does, with a folder of tiles.
  void write_run(const std::string& one, const std::string& two) const {
    RunFolder folder(folder_.string());
    std::ofstream(folder.staged("b.txt")) << two;
    std::ofstream(folder.staged("a.txt")) << one;
    std::ofstream(folder.staged_folder("tiles") + "/index.json") << R"({"format": 1, "tile_cells": 2048})";
    nlohmann::ordered_json report{{"format", 1}, {"map_sha256", ""}};
    report["files"] = files_json(folder);
    write_json(folder.staged("report.json"), report);
    folder.commit();
  }
  static std::string fault_of(const std::function<void()>& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-run-files-" + std::to_string(::getpid())) / "run";
};

TEST_F(RunFilesTest, ARunThatIsReplacedWhileItIsReadIsRefusedWhateverCameOfIt) {
  const char* const replaced = "was changed or replaced while it was read; run the command again";
  const RunFiles run(folder_.string());
  EXPECT_EQ(run.read("a.txt", [](const std::string& file) { return fs::file_size(file); }), 3U);
  EXPECT_THAT(fault_of([&] {
                (void)run.read("a.txt", [this](const std::string& file) -> int {
                  write_run("ONE", "TWO");
                  throw FileError(file, "cannot be read");
                });
              }),
              HasSubstr(replaced));
  EXPECT_THAT(fault_of([&] { (void)run.report(); }), HasSubstr(replaced));
  EXPECT_THAT(fault_of([&] { (void)run.checked("b.txt"); }), HasSubstr(replaced))
      << "a file of the new run against the report of the old one";
}

TEST_F(RunFilesTest, AFolderOfTilesOfSomebodyElseIsNotReplaced) {
  write_run("one", "two");  // those that a run wrote are
  write("tiles/index.json", R"({"tiles": ["https://example.org/{z}/{x}/{y}.png"]})");
  EXPECT_THROW(write_run("one", "two"), UsageError);
  EXPECT_TRUE(fs::exists(path("tiles/index.json")) && fs::exists(path("a.txt")));
}

}  // namespace
}  // namespace gdtslam
