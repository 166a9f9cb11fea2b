// What `gdtslam render` draws of folders: the views that a merged site has, and a path beside a cloud of others.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/render/source.hpp"
#include "tools/gdtslam/render/studio.hpp"
#include "tools/gdtslam/render/views.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

class RenderSourceTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  /// A run of four scans that closed loops, with more in its report.
  [[nodiscard]] RenderSource run_with(const std::string& more) const {
    write("report.json", R"({"format": 1, "log": ["drive.log"], "scans": 4, "matched": 3, "keyframes": 1,
      "path_m": 1.5, "cloud_points": 0, "map_sha256": "0", "keyframe_scans": [0], "doubtful_scans": [],
      "map": {"resolution_m": 0.05, "origin_m": [1.0, 2.0], "width": 2, "height": 1}, "loops": {})" +
                             more + "}");
    write("trajectory.tum", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 9 0 0 0 0 0 1\n4 8 0 0 0 0 0 1\n");
    return RenderSource(folder_.string());
  }

  fs::path folder_ = fs::temp_directory_path() / ("gdtslam-render-source-" + std::to_string(::getpid()));
};

TEST_F(RenderSourceTest, ASiteHasItsGraphButNoReplayOfOneDrive) {
  const unsigned of_a_drive = run_with("").parts();
  const unsigned of_a_site = run_with(R"(, "drives": [2])").parts();
  EXPECT_EQ(of_a_drive, of_a_site | part::kReplay);
  EXPECT_EQ(of_a_site & (part::kGraph | part::kReplay), part::kGraph);
  EXPECT_EQ(views_there_are(of_a_drive, true), "loops");
  EXPECT_EQ(views_there_are(of_a_site, true), "");
  EXPECT_EQ(views_there_are(of_a_site, false), "map, graph, field, trajectory");
  EXPECT_EQ(missing_parts(render_view("loops", ""), of_a_site), "closed loops of one drive");
}

TEST_F(RenderSourceTest, APathBesideACloudInACountrysGridIsWhereTheCloudIs) {
  write("cloud.ply",
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
        "500010.25 5400020.5 0.5\n500011.25 5400020.5 0.5\n");
  write("trajectory.tum", "1 500010.126 5400020.503 0 0 0 0 1\n2 500011.127 5399999.504 0 0 0 0 1\n");
  RenderSource source(folder_.string());
  const Cloud cloud = source.cloud({}).cloud;
  const Trajectory& poses = source.trajectory();
  ASSERT_EQ(cloud.size(), 2U);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(cloud[0].x_m, 10.25F);
  EXPECT_EQ(cloud[0].y_m, 20.5F);
  EXPECT_NEAR(poses[0].T_map_base.x_m, 10.126, 1e-9);
  EXPECT_NEAR(poses[0].T_map_base.y_m, 20.503, 1e-8);
  EXPECT_NEAR(poses[1].T_map_base.x_m, 11.127, 1e-9);
  EXPECT_NEAR(poses[1].T_map_base.y_m, -0.496, 1e-8);
}

constexpr const char* kBareCloud =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
    "0 0 0\n0 7 0\n";

// The second run begins 30 s after the first, and both end together.
TEST_F(RenderSourceTest, ErrorsOfRunsOverTimeHaveOneClock) {
  std::string rows;
  std::string late;
  for (int k = 0; k <= 60; ++k) {
    const std::string row = std::to_string(1000 + k) + " " + std::to_string(0.1 * k) + " 0.01 0 0 0 0 1\n";
    rows += row;
    if (k >= 30) late += row;
  }
  write("truth.tum", rows);
  write("whole.tum", rows);
  write("late.tum", late);
  RenderOptions options;
  options.inputs = {path("whole.tum"), path("late.tum")};
  options.reference = path("truth.tum");
  options.view = "errors";
  options.as = "time";
  std::vector<RenderSource> sources;
  for (const std::string& input : options.inputs) sources.emplace_back(input);
  const Canvas canvas = RenderStudio(options, sources).errors_time(PictureSize{800, 500});
  std::vector<std::vector<Point2>> curves;
  for (const Shape& shape : canvas.shapes()) {
    const auto* const line = std::get_if<shape::Line>(&shape);
    if (line != nullptr && line->points.size() > 20) curves.push_back(line->points);
  }
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_NEAR(curves[0].back().x(), curves[1].back().x(), 0.5);
  EXPECT_NEAR(curves[1].front().x(), 0.5 * (curves[0].front().x() + curves[0].back().x()), 0.5);
}

TEST_F(RenderSourceTest, DistancesReachAsFarAsTheirColours) {
  write("cloud.ply", kBareCloud);
  write("reference.ply", std::string(kBareCloud).replace(std::string(kBareCloud).find("0 7 0"), 5, "0 0 0"));
  RenderOptions options;
  options.inputs = {path("cloud.ply")};
  options.reference = path("reference.ply");
  std::vector<RenderSource> sources;
  sources.emplace_back(options.inputs.front());
  const auto farthest_m = [&](const char* range) {
    options.range = range;
    RenderStudio studio(options, sources);
    return studio.distances(studio.read_cloud(0)).back();
  };
  EXPECT_EQ(farthest_m(""), 1.0F);
  EXPECT_EQ(farthest_m("0m:20cm"), 1.0F);
  EXPECT_EQ(farthest_m("0m:5m"), 5.0F);
  EXPECT_EQ(farthest_m("0m:20m"), 7.0F);
}

TEST_F(RenderSourceTest, ACloudHasNoColoursOfWhatItDoesNotHold) {
  write("bare.ply", kBareCloud);
  write("timed.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
        "property double time\nend_header\n0 0 0 5\n");
  const RenderSource bare(path("bare.ply"));
  for (const CloudColour colour : {CloudColour::kTime, CloudColour::kElevation, CloudColour::kScan}) {
    EXPECT_THROW(bare.require_values(colour), UsageError);
  }
  EXPECT_NO_THROW(bare.require_values(CloudColour::kHeight));
  const RenderSource timed(path("timed.ply"));
  EXPECT_NO_THROW(timed.require_values(CloudColour::kTime));
  EXPECT_THROW(timed.require_values(CloudColour::kScan), UsageError);
}

}  // namespace
}  // namespace gdtslam
