// simulate with a nodding laser: what lies in the log and beside it, and which options count.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "simulate_nodding_fixture.hpp"

namespace gdtslam {
namespace {

TEST_F(SimulateNoddingTest, WritesEncoderLinkageElevationsAndHits) {
  SimulateOptions chosen = options("a.log.gz");
  chosen.truth_hits = true;
  const SimulateResult result = simulate(chosen);
  EXPECT_EQ(result.linkage_file, path("a.linkage.yaml"));
  EXPECT_EQ(result.elevation_file, path("a.elevation.csv"));
  EXPECT_EQ(result.hits_file, path("a.truth.ply"));

  // The log: 0.5 turns a second of 20,000 ticks are 200 ticks a message of 50 Hz, and the count wraps.
  const std::vector<Encoder> told = messages("a.log.gz");
  EXPECT_EQ(told.size(), result.encoder_records);
  ASSERT_GT(told.size(), 200U);
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i].ticks, static_cast<std::int64_t>(200 * i % 20000));
    EXPECT_NEAR(told[i].stamp_s, 0.02 * static_cast<double>(i), 1e-9);
  }

  // The linkage: the preset, with the laser's height and mirror.
  const calib::SweepModel model = read_linkage(result.linkage_file);
  EXPECT_EQ(model.bars.crank_m, 0.036);
  EXPECT_EQ(model.mount.height_m, 0.3);
  EXPECT_EQ(model.mirror_rate_hz, 40.0);
  EXPECT_EQ(model.stamp_share, 0.5);

  // The elevations: one row a scan, of its stamp.
  const std::vector<LaserScan> measured = scans("a.log.gz");
  std::ifstream csv(result.elevation_file);
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "scan,stamp_s,crank_turns,elevation_rad");
  std::size_t rows = 0;
  for (; std::getline(csv, line); ++rows) {
    std::istringstream fields(line);
    double scan = 0;
    double stamp = 0;
    double turns = 0;
    double elevation = 0;
    char comma = ' ';
    fields >> scan >> comma >> stamp >> comma >> turns >> comma >> elevation;
    EXPECT_EQ(scan, static_cast<double>(rows));
    EXPECT_NEAR(stamp, measured.at(rows).stamp_s, 1e-9);
    EXPECT_NEAR(turns, 0.5 * stamp, 1e-9);
    const double crank = model.encoder.zero_rad + model.encoder.direction * 2.0 * kPi * turns;
    EXPECT_NEAR(elevation, *calib::elevation_rad(model, crank), 1e-9);
  }
  EXPECT_EQ(rows, result.scans);

  // The hits: a row for each return, in the log's order, within the room, and within noise of what was measured.
  const std::vector<HitRow> hits = read_hits(result.hits_file);
  ASSERT_EQ(hits.size(), result.returns);
  std::size_t next = 0;
  for (std::size_t scan = 0; scan < measured.size(); ++scan) {
    for (std::size_t beam = 0; beam < measured[scan].ranges_m.size(); ++beam) {
      const double range_m = static_cast<double>(measured[scan].ranges_m[beam]);
      if (range_m >= 20.0) {
        continue;
      }
      const HitRow& hit = hits.at(next++);
      ASSERT_EQ(hit.names[0], scan);
      ASSERT_EQ(hit.names[1], beam);
      EXPECT_NEAR(hit.values[5], range_m, 0.07);
      EXPECT_NEAR(hit.values[4], measured[scan].stamp_s, 0.01);
      EXPECT_TRUE(hit.values[0] > 0.04 && hit.values[0] < 5.96 && hit.values[1] > 0.04 && hit.values[1] < 3.96);
      EXPECT_TRUE(hit.values[2] > -1e-9 && hit.values[2] < 2.5 + 1e-9);
    }
  }
  EXPECT_EQ(next, hits.size());
}

TEST_F(SimulateNoddingTest, OptionsWinOverTheScene) {
  SimulateOptions chosen = options("a.log");
  chosen.crank_rate_hz = 0.1;
  chosen.is_exact = true;
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("a.linkage.yaml")).encoder.ticks_per_turn, std::int64_t{1} << 30);
  // 0.1 Hz of 2^30 ticks at 1 s.
  EXPECT_EQ(messages("a.log")[50].ticks, 107374182);
  // Ranges have nine decimals, and no two neighbours of a wall are equal.
  EXPECT_THAT(content_of(path("a.log")), testing::ContainsRegex(" 97 [0-9]\\.[0-9]{9} "));
  EXPECT_EQ(simulate(chosen).returns, simulate(chosen).beams);

  chosen.ticks_per_turn = 1000;
  chosen.range_resolution_m = 0.5;
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("a.linkage.yaml")).encoder.ticks_per_turn, 1000);
  for (const LaserScan& scan : scans("a.log")) {
    for (const float range_m : scan.ranges_m) {
      EXPECT_EQ(std::fmod(range_m, 0.5F), 0.0F);
    }
  }
}

TEST_F(SimulateNoddingTest, ALinkageFileIsTakenAsItIs) {
  calib::SweepModel model = calib::sweep_model_of_preset("paper-c");
  model.bars.crank_m += 0.0005;
  model.mount.lever_up_m = 0.02;
  model.encoder.ticks_per_turn = 4096;
  write_linkage(path("mine.yaml"), model);
  SimulateOptions chosen = options("a.log");
  chosen.linkage = path("mine.yaml");
  simulate(chosen);
  const calib::SweepModel written = read_linkage(path("a.linkage.yaml"));
  EXPECT_EQ(written.bars.crank_m, model.bars.crank_m);
  EXPECT_EQ(written.mount.lever_up_m, 0.02);
  EXPECT_EQ(written.encoder.ticks_per_turn, 4096);
  // A scene names it relative to itself.
  std::string text = kSmallScene;
  text.replace(text.find("{crank_rate"), 1, "{linkage: mine.yaml, ");
  write("named.yaml", text);
  simulate(options("b.log", "named.yaml"));
  EXPECT_EQ(read_linkage(path("b.linkage.yaml")).bars.crank_m, model.bars.crank_m);
}

}  // namespace
}  // namespace gdtslam

#endif
