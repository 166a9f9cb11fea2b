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
using testing::HasSubstr;

// Lines of the drive's log, a scan each.
std::string some_scans(std::size_t from, std::size_t end) {
  const std::string text = test::text_of_file(ring_run().log);
  std::size_t line = 0;
  std::string some;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    const std::size_t next = text.find('\n', begin) + 1;
    if (line >= from && line < end) some += text.substr(begin, next - begin);
    begin = next;
  }
  return some;
}

void expect_same_results(const std::string& folder, const std::string& other) {
  for (const char* name : {"trajectory.tum", "map.pgm", "gdt.png", "keyframes.bin.gz", "covariance.csv", "graph.g2o"}) {
    EXPECT_EQ(test::text_of_file(folder + "/" + name), test::text_of_file(other + "/" + name)) << name;
  }
}

std::string fault_of_map(const MapRequest& request, Backend& backend) {
  try {
    static_cast<void>(map_logs(request, backend));
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ContinuedRun, AFurtherLogComesBehind) {
  const test::RunsFolder folder("further");
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  std::ofstream(folder.path("a.log")) << some_scans(0, 50);
  std::ofstream(folder.path("b.log")) << some_scans(50, 90);
  static_cast<void>(map_logs(test::ring_request(folder.path("a.log"), folder.path("run")), *cpu));
  MapRequest more = test::ring_request(folder.path("b.log"), folder.path("run"));
  more.continued = folder.path("run");
  const MapOutcome outcome = map_logs(more, *cpu).outcome;
  ASSERT_EQ(outcome.trajectory.size(), 90U);
  for (std::size_t k = 0; k < 90; ++k) {
    const Pose2& truth = ring_run().truth[k];
    EXPECT_LT((outcome.trajectory[k].T_map_base.translation() - truth.translation()).norm(), 0.1) << k;
  }
  const std::vector<std::string> logs{folder.path("a.log"), folder.path("b.log")};
  EXPECT_EQ(RunReader(folder.path("run")).summary().logs, logs);
  EXPECT_THAT(fault_of_map(more, *cpu), HasSubstr("has '" + folder.path("b.log") + "' already"));
  MapRequest at_once = test::ring_request(folder.path("a.log"), folder.path("once"));
  at_once.logs = logs;
  static_cast<void>(map_logs(at_once, *cpu));
  expect_same_results(folder.path("run"), folder.path("once"));
  // A log that was changed, and one that is gone.
  more.logs.clear();
  std::ofstream(folder.path("b.log")) << some_scans(50, 80);
  EXPECT_THAT(fault_of_map(more, *cpu), HasSubstr("has another SHA-256 than the log that the run"));
  fs::remove(folder.path("b.log"));
  EXPECT_THAT(fault_of_map(more, *cpu), HasSubstr("is the log of the run in"));
  expect_same_results(folder.path("run"), folder.path("once"));
}

TEST(ContinuedRun, WhatCannotBeGoneOnWith) {
  const test::RunsFolder folder("no-more");
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const auto fault = [&](const MapRequest& request) { return fault_of_map(request, *cpu); };
  MapRequest request = test::ring_request(ring_run().log, folder.path("run"));
  request.range.count = 20;
  request.with_continue_file = false;
  static_cast<void>(map_logs(request, *cpu));
  EXPECT_FALSE(fs::exists(folder.path("run/continue.json")));
  MapRequest more = test::ring_request("", folder.path("run"));
  more.logs.clear();
  more.continued = folder.path("run");
  EXPECT_THAT(fault(more), HasSubstr("has no continue.json"));
  request.with_continue_file = true;
  static_cast<void>(map_logs(request, *cpu));
  more.logs = {ring_run().log + ".more"};
  EXPECT_THAT(fault(more), HasSubstr("has its first 20 scans only (--first)"));
  request.range = {.skip = 100'000};
  EXPECT_THAT(fault(request),
              HasSubstr("--skip 100000 leaves none of its " + std::to_string(ring_run().truth.size()) + " scans"));
  request.range = {};
  request.stop = [] { return true; };
  EXPECT_THAT(fault(request), HasSubstr("interrupted before the first scan; nothing is written"));
  request.stop = {};
  request.linkage = "paper-a";
  EXPECT_THAT(fault(request), HasSubstr("has no ENCODER or TILT message among its first 10000 records"));
}

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
