// Run folders as people leave them: files missing, cut, edited, of another run. Every message names the file and what
// to do, and nothing ends the process.
#include "engine/runs/folder/run_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// map_sha256: of struct.pack("<dddii", 0.05, 1.0, 2.0, 2, 1) + struct.pack("<HH", 0, 256) in Python.
constexpr const char* kReport = R"({"format": 1, "log": ["../data/drive.log.gz"], "scans": 3, "matched": 2,
 "keyframes": 1, "path_m": 1.5, "cloud_points": 1, "nodding": {"linkage": "paper-a"},
 "map": {"resolution_m": 0.05, "origin_m": [1.0, 2.0], "width": 2, "height": 1},
 "map_sha256": "e0dbc83f4a79fc9df21ae78b2afaf4ae6a040da636b1cc438c0c9d95e61b6dff",
 "doubtful_scans": [{"index": 2, "reason": "contradiction"}], "keyframe_scans": [0]})";

class RunReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("gdtslam-run-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("report.json", kReport);
    write_tum(path("trajectory.tum"), {{1.0, {}}, {2.0, {1.0, 0.0, 0.0}}, {3.0, {1.5, 0.0, 0.1}}});
    write_occupancy_map(path("map.yaml"),
                        {{0.05, 1.0, 2.0, 2, 1}, CellStates(std::vector{CellState::kFree, CellState::kOccupied})});
    write_distance_field(path("gdt.yaml"), rows_of(DistanceFieldView{{0.05, 1.0, 2.0, 2, 1}, 2, cells_, 5120}));
    write_linkage(path("linkage.yaml"), calib::sweep_model_of_preset("paper-a"));
    CloudWriter cloud(path("cloud.ply"), CloudFormat::kPlyBinary);
    cloud.add(std::vector<CloudPoint>(1));
    cloud.finish();
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  void edit(const std::string& from, const std::string& to) const {
    std::string text = kReport;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write("report.json", text.replace(at, from.size(), to));
  }
  RunReader reader() const { return RunReader(folder_.string()); }
  // The message names the file and says how to get a sound run.
  void expect_refused(const std::function<void()>& act, const std::string& file, const std::string& fault) const {
    try {
      act();
      ADD_FAILURE() << file << ": " << fault << ": nothing was thrown";
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(error.code() == ExitCode::kBadInput || error.code() == ExitCode::kInputOutput) << what;
      EXPECT_NE(what.find(file), std::string::npos) << what;
      EXPECT_NE(what.find(fault), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }

  fs::path folder_;
  std::vector<std::uint16_t> cells_{0, 256};
};

TEST_F(RunReaderTest, ReadsWhatARunHolds) {
  const RunReader run = reader();
  EXPECT_EQ(run.name(), "drive");
  EXPECT_EQ(run.summary().scans, 3U);
  EXPECT_EQ(run.summary().doubtful, std::vector<std::size_t>{2});
  EXPECT_EQ(run.summary().keyframes, std::vector<std::size_t>{0});
  EXPECT_EQ(run.trajectory().size(), 3U);
  EXPECT_EQ(run.map().geometry.width, 2);
  EXPECT_EQ(run.field().cells, cells_);
  EXPECT_EQ(run.cloud_file(), path("cloud.ply"));
  EXPECT_EQ(run.linkage().value().name, "paper-a");
}

TEST_F(RunReaderTest, RunsOfEarlierVersionsDoWithoutKeyframesAndLinkage) {
  edit(", \"keyframe_scans\": [0]", "");
  fs::remove(path("linkage.yaml"));
  EXPECT_TRUE(reader().summary().keyframes.empty());
  EXPECT_FALSE(reader().keyframes().has_value());
  EXPECT_FALSE(reader().linkage().has_value());
}

TEST_F(RunReaderTest, CovariancesAreThoseOfTheTrajectory) {
  EXPECT_FALSE(reader().covariances().has_value()) << "of a run that closed no loops";
  const std::string header = "stamp_s,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2\n";
  const std::string rows = "1.000000000,1,0,0,1,0,1\n2.000000000,0.25,0,0,1,0,1\n";
  write("covariance.csv", header + rows + "3.000000000,1,0,0,1,0,1\n");
  EXPECT_EQ(reader().covariances().value().at(1).xx, 0.25);
  write("covariance.csv", header + rows);
  expect_refused([this] { (void)reader().covariances(); }, path("covariance.csv"), "has 2 rows");
}

TEST_F(RunReaderTest, ARunIsToldByItsReport) {
  EXPECT_TRUE(RunReader::is_gdtslam_run(folder_.string()));
  edit("\"format\": 1", "\"format\": 2");
  EXPECT_TRUE(RunReader::is_gdtslam_run(folder_.string())) << "of another version";
  for (const char* foreign : {"", "[1, 2]", "{\"format\": 1}", "{\"map_sha256\": \"\"}"}) {
    write("report.json", foreign);
    EXPECT_FALSE(RunReader::is_gdtslam_run(folder_.string())) << foreign;
  }
  fs::remove(path("report.json"));
  EXPECT_FALSE(RunReader::is_gdtslam_run(folder_.string()));
}

}  // namespace
}  // namespace gdtslam
