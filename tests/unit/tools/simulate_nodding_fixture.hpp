// What the tests of simulate with a nodding laser share: a small scene in a folder of its own, and readers of what is
// written.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "tools/gdtslam/scenes/simulate_run.hpp"

namespace gdtslam {

inline std::string content_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct HitRow {
  std::array<double, 6> values{};        // x y z elevation time range
  std::array<std::uint32_t, 3> names{};  // scan beam triangle
};

// A reader of its own for the one layout that is promised.
inline std::vector<HitRow> read_hits(const std::string& path) {
  const std::string bytes = content_of(path);
  const std::string header =
      "property double x\nproperty double y\nproperty double z\nproperty double elevation\nproperty double time\n"
      "property double range\nproperty uint scan\nproperty uint beam\nproperty uint triangle\nend_header\n";
  const std::size_t at = bytes.find(header);
  EXPECT_EQ(bytes.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
  EXPECT_NE(at, std::string::npos);
  const std::size_t begin = at + header.size();
  std::vector<HitRow> rows((bytes.size() - begin) / 60);
  EXPECT_EQ((bytes.size() - begin) % 60, 0U);
  EXPECT_THAT(bytes.substr(0, begin), testing::HasSubstr("element vertex " + std::to_string(rows.size()) + "\n"));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::memcpy(rows[i].values.data(), bytes.data() + begin + 60 * i, 48);
    std::memcpy(rows[i].names.data(), bytes.data() + begin + 60 * i + 48, 12);
  }
  return rows;
}

class SimulateNoddingTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = std::filesystem::path(testing::TempDir()) / ("simulate_nodding_" + name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("small.yaml", kSmallScene);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  [[nodiscard]] SimulateOptions options(const std::string& output, const std::string& scene = "small.yaml") const {
    SimulateOptions options;
    options.scene = path(scene);
    options.output = path(output);
    return options;
  }

  [[nodiscard]] std::vector<Encoder> messages(const std::string& log) const {
    std::vector<Encoder> list;
    const auto reader = open_log(path(log), {});
    while (const auto record = reader->next()) {
      if (const auto* message = std::get_if<Encoder>(&*record)) list.push_back(*message);
    }
    EXPECT_TRUE(reader->warnings().empty());
    return list;
  }

  [[nodiscard]] std::vector<LaserScan> scans(const std::string& log) const {
    std::vector<LaserScan> list;
    const auto reader = open_log(path(log), {});
    while (const auto record = reader->next()) {
      if (const auto* scan = std::get_if<ScanRecord>(&*record)) list.push_back(scan->scan);
    }
    return list;
  }

  static constexpr const char* kSmallScene = R"(gdtslam_scene: 1
walls:
  - {points: [[0, 0], [6, 0], [6, 4], [0, 4]], closed: true}
floor: 0
ceiling: 2.5
robot:
  laser: {preset: hokuyo-961, beams: 97, bearing_step: 2.5 deg, mount: {x: 10 cm}, drop_outs: 1 %}
  nodding: {crank_rate: 0.5, encoder: {rate: 50}}
recording: {scan_rate: 5, odometry_rate: 10}
waypoints: [[1, 1], [4.5, 1], [4.5, 2]]
)";
  std::filesystem::path folder_;
};

}  // namespace gdtslam
