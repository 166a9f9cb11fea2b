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

#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
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
  write("covariance.csv", header + rows + "4.000000000,1,0,0,1,0,1\n");
  expect_refused([this] { (void)reader().covariances(); }, path("covariance.csv"), "row 3 is of 4 s");
}

TEST_F(RunReaderTest, ReportsThatCannotBeUsed) {
  const auto refused = [this](const std::string& fault) {
    expect_refused([this] { reader(); }, path("report.json"), fault);
    expect_refused([this] { reader(); }, path("report.json"),
                   "map the log again: gdtslam map LOG -o " + folder_.string());
  };
  const std::pair<const char*, const char*> edits[]{{"\"scans\": 3", "'scans'"},
                                                    {"\"matched\": 2", "'matched'"},
                                                    {"\"keyframes\": 1", "'keyframes'"},
                                                    {"\"path_m\": 1.5", "'path_m'"},
                                                    {"\"log\": [", "'log'"},
                                                    {"\"doubtful_scans\": [", "'doubtful_scans'"},
                                                    {"\"map_sha256\": ", "'map_sha256'"},
                                                    {"\"cloud_points\": 1", "'cloud_points'"}};
  for (const auto& [member, name] : edits) {
    edit(member, "\"x" + std::string(member).substr(1));
    refused("has no " + std::string(name));
  }
  edit("\"scans\": 3", "\"scans\": -3");
  refused("'scans' is not a whole number");
  edit("\"scans\": 3", "\"scans\": \"three\"");
  refused("'scans' is not a whole number");
  edit("\"path_m\": 1.5", "\"path_m\": null");
  refused("'path_m' is not a number");
  edit("[\"../data/drive.log.gz\"]", "[]");
  refused("'log' is empty");
  edit("[\"../data/drive.log.gz\"]", "[7]");
  refused("'log' is not a list of texts");
  edit("\"index\": 2", "\"index\": 3");
  refused("'doubtful_scans' names a scan that is none of its 3");
  edit("\"keyframe_scans\": [0]", "\"keyframe_scans\": [99999999999999999999]");
  refused("'keyframe_scans' names a scan");
  edit("\"origin_m\": [1.0, 2.0]", "\"origin_m\": [1.0]");
  refused("'map.origin_m' is not 2 numbers");
  edit("\"map_sha256\": \"", "\"map_sha256\": 7, \"x\": \"");
  refused("'map_sha256' is not a text");
  edit("\"format\": 1", "\"format\": 2");
  refused("has format 2, and this program reads format 1");
  write("report.json", std::string(kReport).substr(0, 60));
  refused("is no JSON text");
  write("report.json", "");
  refused("is no JSON text");
  write("report.json", "[1, 2]");
  refused("does not hold a JSON object");
  fs::remove(path("report.json"));
  expect_refused([this] { reader(); }, folder_.string(), "it has no report.json; map the log again");
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

TEST_F(RunReaderTest, FilesThatAreDamagedOrOfAnotherRun) {
  write("trajectory.tum", "1 0 0 0 0 0 0 1\n");
  expect_refused([this] { static_cast<void>(reader().trajectory()); }, path("trajectory.tum"),
                 "has 1 poses, but report.json tells of 3 scans");
  write("trajectory.tum", "1 0 0 zero 0 0 0 1\n");
  expect_refused([this] { static_cast<void>(reader().trajectory()); }, path("trajectory.tum") + ":1", "");
  write_occupancy_map(path("map.yaml"),
                      {{0.1, 1.0, 2.0, 2, 1}, CellStates(std::vector{CellState::kFree, CellState::kOccupied})});
  expect_refused(
      [this] { static_cast<void>(reader().map()); }, path("map.yaml"),
      "has 2 x 1 cells of 0.1 m from (1, 2), but report.json tells of 2 x 1 cells of 0.05 m from (1, 2): not of "
      "one run; map the log again");
  write_distance_field(path("gdt.yaml"),
                       rows_of(DistanceFieldView{{0.05, 1.0, 2.0, 2, 1}, 2, std::vector<std::uint16_t>{0, 512}, 5120}));
  expect_refused([this] { static_cast<void>(reader().field()); }, path("gdt.png"),
                 "is not the distance field that report.json tells of: not of one run; map the log again");
  write("map.pgm", "P5\n2 1\n255\n");
  expect_refused([this] { static_cast<void>(reader().map()); }, path("map.pgm"), "");
  write("gdt.png", "no picture");
  expect_refused([this] { static_cast<void>(reader().field()); }, path("gdt.png"), "");
  write("linkage.yaml", "gdtslam_linkage: 1\nbars: 7\n");
  EXPECT_THROW(static_cast<void>(reader().linkage()), ConfigError);
}

}  // namespace
}  // namespace gdtslam
