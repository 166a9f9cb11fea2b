// What a command takes for a trajectory or a cloud: files, runs, folders of other programs, and what it says of folders
// that have none.
#include "engine/runs/folder/run_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGivenPoses = "1 0.5 0 0 0 0 0 1\n2 1.5 0 0 0 0 0 1\n";

class GivenFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("gdtslam-given-" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "run");
    fs::create_directories(folder_ / "other");
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  static std::string fault_of(const std::function<void()>& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  fs::path folder_;
};

TEST_F(GivenFilesTest, AFolderOfAnotherProgramWillDoIfItHasTheFile) {
  write("other/trajectory.tum", kGivenPoses);
  write("other/cloud.ply", "ply\n");
  EXPECT_EQ(given_trajectory(path("other")).size(), 2U);
  EXPECT_EQ(given_cloud(path("other")), path("other/cloud.ply"));
}

TEST_F(GivenFilesTest, ARunWithoutItsReportIsNone) {
  write("run/trajectory.tum", kGivenPoses);
  write("run/cloud.ply", "ply\n");
  const auto is_refused = [&](const char* why) {
    for (const auto& [file, act] :
         {std::pair<const char*, std::function<void()>>{"trajectory.tum", [&] { given_trajectory(path("run")); }},
          {"cloud.ply", [&] { given_cloud(path("run")); }}}) {
      const std::string fault = fault_of(act);
      EXPECT_NE(fault.find("is a folder without report.json, so no run"), std::string::npos) << why << ": " << fault;
      EXPECT_NE(fault.find("name " + std::string(file) + " in it itself"), std::string::npos) << why << ": " << fault;
    }
  };
  for (const char* const left : {"run/keyframes.bin.gz", "run/gdt.yaml"}) {
    EXPECT_EQ(given_trajectory(path("run")).size(), 2U) << "without " << left;
    write(left, "left");
    is_refused(left);
    EXPECT_EQ(given_trajectory(path("run/trajectory.tum")).size(), 2U) << "the file itself";
    fs::remove(path(left));
  }
}

}  // namespace
}  // namespace gdtslam
