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

// printf one | sha256sum
constexpr const char* kHashOfOne = "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed";

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
  [[nodiscard]] std::string fault_of_one() const {
    return fault_of([this] { (void)RunFiles(folder_.string()).checked("a.txt"); });
  }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-run-files-" + std::to_string(::getpid())) / "run";
};

TEST_F(RunFilesTest, TheReportHasNameBytesAndHashOfEachFile) {
  const nlohmann::ordered_json files = read_json(path("report.json"), kMostReportBytes).at("files");
  ASSERT_EQ(files.size(), 2U) << files;
  EXPECT_EQ(files[0], (nlohmann::ordered_json{"a.txt", 3, kHashOfOne}));
  EXPECT_EQ(files[1].at(0), "b.txt");
  const RunFiles run(folder_.string());
  EXPECT_TRUE(run.is_told() && run.has("a.txt") && !run.has("c.txt"));
  EXPECT_EQ(run.checked("a.txt"), path("a.txt"));
  EXPECT_EQ(run.sha256("a.txt"), kHashOfOne);
}

TEST_F(RunFilesTest, AnotherFileIsRefused) {
  write("a.txt", "onE");
  EXPECT_THAT(fault_of_one(), HasSubstr(path("a.txt") +
                                        ": has another SHA-256 than report.json names: not of one run; "
                                        "map the log again: gdtslam map LOG -o " +
                                        folder_.string()));
  write("a.txt", "on");
  EXPECT_THAT(fault_of_one(), HasSubstr("has 2 bytes, but report.json names 3: not of one run"));
  fs::remove(path("a.txt"));
  EXPECT_THAT(fault_of_one(), HasSubstr("a.txt: is missing in this run; map the log again"));
  fs::create_directory(path("a.txt"));
  EXPECT_THAT(fault_of_one(), HasSubstr("a.txt: is missing in this run"));
  write("c.txt", "one");
  EXPECT_THAT(fault_of([this] { (void)RunFiles(folder_.string()).checked("c.txt"); }),
              HasSubstr("c.txt: is none of the files that report.json names"));
}

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

TEST_F(RunFilesTest, FilesOfOlderVersionsAreTakenAsTheyAre) {
  write("report.json", R"({"format": 1, "map_sha256": ""})");
  write("a.txt", "anything");
  const RunFiles run(folder_.string());
  EXPECT_FALSE(run.is_told());
  EXPECT_EQ(run.checked("a.txt"), path("a.txt"));
  write("c.txt", "one");
  EXPECT_TRUE(run.has("c.txt"));
  EXPECT_EQ(run.sha256("c.txt"), kHashOfOne);
  EXPECT_THAT(fault_of([&] { (void)run.checked("d.txt"); }), HasSubstr("is missing in this run"));
}

TEST_F(RunFilesTest, AFolderOfTilesOfSomebodyElseIsNotReplaced) {
  write_run("one", "two");  // those that a run wrote are
  write("tiles/index.json", R"({"tiles": ["https://example.org/{z}/{x}/{y}.png"]})");
  EXPECT_THROW(write_run("one", "two"), UsageError);
  EXPECT_TRUE(fs::exists(path("tiles/index.json")) && fs::exists(path("a.txt")));
}

}  // namespace
}  // namespace gdtslam
