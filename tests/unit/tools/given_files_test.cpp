// What a command takes for a trajectory or a cloud: files, runs, folders of other programs, and what it says of folders
// that have none.
#include "engine/runs/inputs/given_files.hpp"

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
  // A report of two scans whose laser nods or does not.
  void write_report(std::uint64_t cloud_points, bool nods) const {
    write("run/report.json",
          R"({"format": 1, "log": ["a.log"], "scans": 2, "matched": 2, "keyframes": 1, "path_m": 1, "map_sha256": "00",
              "doubtful_scans": [], "cloud_points": )" +
              std::to_string(cloud_points) + (nods ? R"(, "nodding": {"linkage": "paper-b"}})" : "}"));
  }
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

TEST_F(GivenFilesTest, AFileIsTakenAsItIs) {
  write("poses.tum", kGivenPoses);
  EXPECT_EQ(given_trajectory(path("poses.tum")).size(), 2U);
  EXPECT_EQ(given_cloud(path("a.pcd")), path("a.pcd"));
  EXPECT_THROW(given_trajectory(path("nowhere.tum")), FileError);
}

TEST_F(GivenFilesTest, ARunHasBoth) {
  write_report(3, true);
  write("run/trajectory.tum", kGivenPoses);
  write("run/cloud.ply", "ply\n");
  EXPECT_DOUBLE_EQ(given_trajectory(path("run")).back().T_map_base.x_m, 1.5);
  EXPECT_EQ(given_cloud(path("run")), path("run/cloud.ply"));
}

TEST_F(GivenFilesTest, ARunIsCheckedAgainstItsReport) {
  write_report(3, true);
  write("run/trajectory.tum", "1 0.5 0 0 0 0 0 1\n");
  EXPECT_NE(fault_of([&] { given_trajectory(path("run")); }).find("has 1 poses"), std::string::npos);
  EXPECT_NE(fault_of([&] { given_cloud(path("run")); }).find("cloud.ply: is missing in this run"), std::string::npos);
}

TEST_F(GivenFilesTest, ARunWithoutACloudSaysWhy) {
  write_report(0, false);
  const std::string flat = fault_of([&] { given_cloud(path("run")); });
  EXPECT_NE(flat.find("this run has no cloud: 'map' makes one where the laser nods"), std::string::npos) << flat;
  write_report(0, true);
  const std::string left_out = fault_of([&] { given_cloud(path("run")); });
  EXPECT_NE(left_out.find("this run has no cloud: it was mapped with --no-cloud"), std::string::npos) << left_out;
}

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

TEST_F(GivenFilesTest, AFileWithoutRowsIsToldByName) {
  write("empty.tum", "# stamp x y z qx qy qz qw\n");
  EXPECT_NE(fault_of([&] { given_trajectory(path("empty.tum")); }).find("empty.tum: holds no pose"), std::string::npos);
}

TEST_F(GivenFilesTest, AFolderWithoutTheFileIsRefusedByName) {
  for (const auto& [file, act] :
       {std::pair<const char*, std::function<void()>>{"trajectory.tum", [&] { given_trajectory(path("other")); }},
        {"cloud.ply", [&] { given_cloud(path("other")); }}}) {
    const std::string fault = fault_of(act);
    EXPECT_NE(fault.find(path("other") + ": is a folder without report.json"), std::string::npos) << fault;
    EXPECT_NE(fault.find(std::string("has no ") + file), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace gdtslam
