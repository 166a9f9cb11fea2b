// A run that is continued, and a run as a recording: against the run made at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_recording.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using test::ring_run;

TEST(RunWithout, LoopsOrMapHasNoFilesOfThem) {
  const test::RunsFolder folder("without");
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapRequest request = test::ring_request(ring_run().log, folder.path("run"));
  request.range = {.skip = 10, .count = 40};
  static_cast<void>(map_logs(request, *cpu));
  EXPECT_TRUE(fs::exists(folder.path("run/map.pgm")));
  request.with_loops = false;
  request.with_map = false;
  const MapResult result = map_logs(request, *cpu);  // into the same folder
  EXPECT_EQ(result.outcome.trajectory.size(), 40U);
  EXPECT_NEAR(result.outcome.trajectory[0].stamp_s, 1005.0, 1e-6);
  EXPECT_FALSE(result.outcome.closed);
  for (const char* name : {"map.pgm", "map.yaml", "covariance.csv", "graph.g2o"}) {
    EXPECT_FALSE(fs::exists(folder.path("run/") + name)) << name;
  }
  const RunReader reader(folder.path("run"));
  EXPECT_FALSE(reader.summary().map);
  EXPECT_FALSE(reader.summary().has_loops);
  EXPECT_FALSE(reader.covariances());
  EXPECT_FALSE(reader.keyframes()->in_single_precision);
  // Odometry that is said to be late: 0.25 s of a drive that goes 0.5 m a second.
  request.settings.log.odometry_stamps = OdometryStamps::kStated;
  request.settings.log.odometry_delay_s = 0.25;
  const ordered_json report = ordered_json::parse(map_logs(request, *cpu).report);
  EXPECT_EQ(report.at("odometry_delay").at("delay_s"), 0.25);
  EXPECT_EQ(report.at("odometry_delay").at("sigma_s"), 0.0);
  EXPECT_EQ(report.at("matched"), 40);
}

TEST(RecordingOfARun, HasEachScanAndItsPose) {
  const test::RunsFolder folder("recording");
  const MapOutcome& outcome = ring_run().result.outcome;
  EXPECT_EQ(write_run_recording(folder.path("run.mcap"), {ring_run().log}, {}, {.skip = 2, .count = 50}, outcome), 0U);
  const auto log = open_log(folder.path("run.mcap"), {});
  std::size_t scans = 0;
  while (const auto record = log->next()) {
    const auto* scan = std::get_if<ScanRecord>(&*record);
    if (scan == nullptr) continue;
    EXPECT_NEAR(scan->scan.stamp_s, 1001.0 + 0.5 * static_cast<double>(scans), 1e-6);
    EXPECT_EQ(scan->scan.ranges_m.size(), 180U);
    ++scans;
  }
  EXPECT_EQ(scans, 50U);
}

}  // namespace
}  // namespace gdtslam
