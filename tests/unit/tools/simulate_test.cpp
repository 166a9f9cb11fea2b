// The whole way from a scene file to a log: the bytes, what a reader makes of them, and the sample scenes.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include "tools/gdtslam/scenes/simulate_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

const std::string kSceneFolder = GDTSLAM_SOURCE_DIR "/assets/scenes";

std::string content_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string sha256_of_file(const std::string& path) {
  Sha256 digest;
  digest.update(content_of(path));
  return digest.hex();
}

class SimulateTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("simulate_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    small_ = path("small.yaml");
    std::ofstream(small_) << kSmallScene;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  [[nodiscard]] SimulateOptions options(const std::string& output) const {
    SimulateOptions options;
    options.scene = small_;
    options.output = path(output);
    return options;
  }

  static constexpr const char* kSmallScene = R"(gdtslam_scene: 1
walls:
  - {points: [[0, 0], [6, 0], [6, 4], [0, 4]], closed: true}
boxes:
  - {centre: [3, 3.2], size: [0.4, 0.4], height: 1, yaw: 30 deg}
robot: {laser: {mount: {x: 10 cm}, drop_outs: 1 %, noise: 2 cm}, wheels: {slip: 1 cm}}
recording: {scan_rate: 5, odometry_rate: 10}
waypoints: [[1, 1], [4.5, 1], [4.5, 2]]
)";
  std::filesystem::path folder_;
  std::string small_;
};

TEST_F(SimulateTest, WritesALogThatAReaderUnderstands) {
  const SimulateResult result = simulate(options("a.log"));
  EXPECT_EQ(result.truth_file, path("a.truth.tum"));
  EXPECT_EQ(result.log_bytes, std::filesystem::file_size(path("a.log")));
  const Trajectory truth = read_tum(result.truth_file);
  ASSERT_EQ(truth.size(), result.scans);
  EXPECT_NEAR(truth.front().T_map_base.x_m, 1.0, 1e-9);
  const auto reader = open_log(path("a.log"), {});
  std::size_t scans = 0;
  std::size_t odometry = 0;
  std::size_t returns = 0;
  while (const auto record = reader->next()) {
    if (const auto* scan = std::get_if<ScanRecord>(&*record)) {
      ASSERT_LT(scans, truth.size());
      EXPECT_NEAR(scan->scan.stamp_s, truth[scans].stamp_s, 1e-9);
      EXPECT_EQ(scan->scan.ranges_m.size(), 180U);
      EXPECT_NEAR(scan->scan.first_bearing_rad, -0.5 * kPi, 1e-12);
      EXPECT_NEAR(scan->scan.T_base_laser.x_m, 0.1, 2e-6);
      EXPECT_EQ(scan->scan.max_range_m, 80.0);
      for (const float range_m : scan->scan.ranges_m) {
        returns += range_m < 80.0F ? 1 : 0;
        EXPECT_TRUE(range_m < 8.0F || range_m == 81.91F);
      }
      ++scans;
    } else if (std::holds_alternative<Odometry>(*record)) {
      ++odometry;
    }
  }
  EXPECT_EQ(scans, result.scans);
  EXPECT_EQ(odometry, result.odometry_records);
  EXPECT_EQ(returns, result.returns);
  EXPECT_TRUE(reader->warnings().empty());
  const double share = 1.0 - static_cast<double>(returns) / static_cast<double>(result.beams);
  EXPECT_NEAR(share, 0.01, 5.0 * std::sqrt(0.01 / static_cast<double>(result.beams)));
}

TEST_F(SimulateTest, TheSameSeedGivesTheSameBytesOnAnyInstructionSetOfEmbree) {
  simulate(options("a.log"));
  SimulateOptions chosen = options("b.log");
  for (const char* isa : {"", "sse2", "avx2", "avx512"}) {
    chosen.embree_isa = isa;
    try {
      simulate(chosen);
    } catch (const UnavailableError&) {
      continue;  // not on this processor
    }
    EXPECT_EQ(content_of(path("a.log")), content_of(path("b.log"))) << isa;
    EXPECT_EQ(content_of(path("a.truth.tum")), content_of(path("b.truth.tum"))) << isa;
  }
  chosen.seed = 2;
  chosen.embree_isa = "";
  simulate(chosen);
  EXPECT_NE(content_of(path("a.log")), content_of(path("b.log")));
  EXPECT_EQ(content_of(path("a.truth.tum")), content_of(path("b.truth.tum")));
}

TEST_F(SimulateTest, StoppedEarlyItWritesWhatItHas) {
  SimulateOptions chosen = options("a.log");
  std::uint64_t scans = 0;
  chosen.progress = [&](std::uint64_t count, double) { scans = count; };
  chosen.stop = [&] { return scans >= 4; };
  const SimulateResult result = simulate(chosen);
  EXPECT_FALSE(result.is_whole);
  EXPECT_EQ(read_tum(path("a.truth.tum")).size(), 4U);
}

TEST_F(SimulateTest, RefusesAPathThroughAWall) {
  std::ofstream(path("t.yaml")) << "gdtslam_trajectory: 1\nwaypoints: [[1, 1], [5.9, 1]]\n";
  SimulateOptions chosen = options("a.log");
  chosen.trajectory = path("t.yaml");
  try {
    simulate(chosen);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("t.yaml: the path comes within 0.0"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("a.log")));
}

struct SampleScene {
  const char* name;
  std::size_t scans;
  double path_m;
  const char* log_sha256;
  const char* truth_sha256;
};

class SampleSceneTest : public SimulateTest, public testing::WithParamInterface<SampleScene> {};

TEST_P(SampleSceneTest, GivesTheExpectedBytes) {
  SimulateOptions chosen = options("s.log");
  chosen.scene = GetParam().name;
  chosen.scene_folders = {kSceneFolder};
  const SimulateResult result = simulate(chosen);
  EXPECT_EQ(result.scans, GetParam().scans);
  EXPECT_NEAR(result.path_m, GetParam().path_m, 0.1);
  EXPECT_EQ(sha256_of_file(path("s.log")), GetParam().log_sha256);
  EXPECT_EQ(sha256_of_file(path("s.truth.tum")), GetParam().truth_sha256);
  chosen.embree_isa = "sse2";
  simulate(chosen);
  EXPECT_EQ(sha256_of_file(path("s.log")), GetParam().log_sha256);
}

INSTANTIATE_TEST_SUITE_P(
    Samples, SampleSceneTest,
    testing::Values(SampleScene{"office-loop", 2884, 204.8,
                                "d7d0c4e2eeec3e656a80732005da33a342036e16f1bacc7b83eca50499cff2ce",
                                "84ec527ef32446ccae6a09df775934481e17f8177734b59884071225189b3c55"},
                    SampleScene{"corridor", 1440, 101.8,
                                "65d685f591a1c2773f865d0765d3f9fa4fac60dd75154525728f96a765e6fb18",
                                "34afc86b999c5e6400c40de7ed6bf6c541824954cfa01f8ce298e1311f821465"}),
    [](const auto& sample) { return std::string(sample.param.name) == "corridor" ? "Corridor" : "OfficeLoop"; });

}  // namespace
}  // namespace gdtslam

#endif
