// Two drives through the same corridor, each mapped in its own frame: joined, both lie where they were driven.
#include "engine/runs/sites/merge_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/io/sha256.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "ring_run.hpp"
#include "unit/back_end/loop_drive.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using test::ring_run;
using testing::HasSubstr;

// The second drive begins where the first one has gone 30 poses, and goes half around.
std::vector<Pose2> second_ring_drive() {
  const std::vector<Pose2> truth = test::poses_around_ring(1);
  return {truth.begin() + 30, truth.begin() + 190};
}

class MergedRunsTest : public testing::Test {
 protected:
  // Mapped once for all tests of the process.
  static const std::string& second_run() {
    static const test::RunsFolder folder("second-run");
    static const std::string run = [] {
      test::write_ring_log(folder.path("second.log"), second_ring_drive(), 77);
      const std::unique_ptr<Backend> cpu = make_cpu_backend({});
      static_cast<void>(map_logs(test::ring_request(folder.path("second.log"), folder.path("second")), *cpu));
      return folder.path("second");
    }();
    return run;
  }
  struct MergedOnce {
    std::string folder;
    MergeOutcome outcome;
    std::string report;
  };
  static const MergedOnce& merged_once() {
    static const test::RunsFolder folder("merged-once");
    static const MergedOnce once = [] {
      MergeRequest request;
      request.runs = {second_run(), ring_run().folder};
      request.folder = folder.path("site");
      request.with_pictures = false;
      MergeOutcome outcome = merge_runs(request);
      std::string report = outcome.report;
      return MergedOnce{request.folder, std::move(outcome), std::move(report)};
    }();
    return once;
  }
  void SetUp() override {
    request_.runs = {second_run(), ring_run().folder};
    request_.folder = folder_.path("site");
    request_.with_pictures = false;
  }
  [[nodiscard]] std::string merge_fault() const {
    try {
      static_cast<void>(merge_runs(request_));
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  const test::RunsFolder folder_{"merged"};
  MergeRequest request_;
};

TEST_F(MergedRunsTest, LieInOneFrame) {
  const MergeOutcome& outcome = merged_once().outcome;
  const std::string& site_folder = merged_once().folder;
  ASSERT_EQ(outcome.sites.size(), 1U);
  const JoinedSite& site = outcome.sites.front();
  ASSERT_EQ(site.runs.size(), 2U);
  // By time and not as they are named: both begin at 1000 s, so by the hash of their keyframes.
  const bool is_ring_first = site.runs[0].folder == ring_run().folder;
  std::vector<std::vector<Pose2>> drives{test::ring_drive(), second_ring_drive()};
  if (!is_ring_first) std::swap(drives[0], drives[1]);
  const Pose2 T_site_world = inverse(drives[0].front());
  std::size_t scans = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(site.runs[k].scans, drives[k].size());
    const Trajectory path = read_tum(site_folder + "/" + site.runs[k].trajectory_file);
    ASSERT_EQ(path.size(), drives[k].size());
    for (std::size_t i = 0; i < path.size(); i += 9) {
      const Pose2 truth = T_site_world * drives[k][i];
      EXPECT_LT((path[i].T_map_base.translation() - truth.translation()).norm(), 0.12) << k << ' ' << i;
    }
    scans += path.size();
  }
  EXPECT_GT(site.loops_between, 0U);
  EXPECT_EQ(site.changes.readings, 0U) << "nothing changed in between";
  const RunReader reader(site.folder);
  EXPECT_EQ(reader.summary().scans, scans);
  EXPECT_EQ(reader.summary().drives, (std::vector<std::size_t>{drives[0].size()}));
  EXPECT_EQ(reader.summary().map_sha256, site.map_sha256);
  EXPECT_EQ(reader.keyframes()->keyframes.size(), site.keyframes);
  EXPECT_FALSE(fs::exists(site.folder + "/continue.json"));

  const ordered_json report = ordered_json::parse(outcome.report);
  EXPECT_EQ(outcome.report, test::text_of_file(site_folder + "/merge.json"));
  ASSERT_EQ(report.at("sites").size(), 1U);
  EXPECT_EQ(report.at("sites")[0].at("folder"), "1");
  EXPECT_EQ(report.at("sites")[0].at("runs")[1].at("trajectory"), "1/session-2.tum");
  EXPECT_EQ(report.at("sites")[0].at("loops_between"), site.loops_between);
  ASSERT_EQ(report.at("searches").size(), 1U);
  EXPECT_EQ(report.at("searches")[0].at("is_joined"), true);
  EXPECT_EQ(report.at("searches")[0].at("searched_in").size(), 1U);
  ASSERT_EQ(report.at("edges").size(), 1U);
  const ordered_json& fixes = report.at("edges")[0].at("fixes");
  EXPECT_EQ(report.at("searches")[0].at("agree"), fixes.size());
  ASSERT_FALSE(fixes.empty());
  for (const ordered_json& fix : fixes) EXPECT_LT(fix.at("mean_distance_m").get<double>(), 0.05);
}

TEST_F(MergedRunsTest, TheirOrderDoesNotMatter) {
  fs::copy(merged_once().folder, request_.folder, fs::copy_options::recursive);
  std::swap(request_.runs[0], request_.runs[1]);
  EXPECT_EQ(merge_runs(request_).report, merged_once().report);
  EXPECT_TRUE(fs::exists(request_.folder + "/1/session-2.tum"));
}

// No edit takes all that was seen; another program that writes runs might.
TEST_F(MergedRunsTest, ARunThatSawNothingIsNamed) {
  const std::string blank = folder_.path("blank");
  const std::string file = blank + "/keyframes.bin.gz";
  fs::copy(second_run(), blank);
  RunKeyframes kept = read_keyframes(file).run;
  for (RunKeyframe& keyframe : kept.keyframes) {
    for (float& range_m : keyframe.laser.ranges_m) range_m = std::numeric_limits<float>::infinity();
  }
  ordered_json report = ordered_json::parse(test::text_of_file(blank + "/report.json"));
  report["keyframes_sha256"] = write_keyframes(file, kept);
  for (ordered_json& row : report["files"]) {
    if (row[0] != "keyframes.bin.gz") continue;
    const std::string bytes = test::text_of_file(file);
    row = {row[0], bytes.size(), Sha256().update(bytes).hex()};
  }
  std::ofstream(blank + "/report.json") << report.dump();
  request_.runs = {ring_run().folder, blank};
  EXPECT_THAT(merge_fault(), HasSubstr(blank + ": has no keyframe with a return"));
  EXPECT_FALSE(fs::exists(request_.folder + "/merge.json"));
}

TEST_F(MergedRunsTest, WhatCannotBeJoined) {
  request_.runs = {ring_run().folder, ring_run().folder};
  EXPECT_THAT(merge_fault(), HasSubstr("is the same run as"));
  request_.runs = {ring_run().folder, second_run()};
  std::vector<double> shares;
  request_.progress = [&](std::string_view what, double share) {
    if (what == "reading runs") shares.push_back(share);
  };
  request_.stop = [&] { return shares.size() == 2; };
  EXPECT_THAT(merge_fault(), HasSubstr("interrupted; no site was written"));
  EXPECT_EQ(shares, (std::vector<double>{0.0, 0.5}));
  EXPECT_FALSE(fs::exists(request_.folder + "/merge.json"));
  request_.stop = {};
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapRequest bare = test::ring_request(second_run() + ".log", folder_.path("bare"));
  bare.with_loops = false;
  bare.range.count = 30;
  static_cast<void>(map_logs(bare, *cpu));
  request_.runs = {folder_.path("bare"), ring_run().folder};
  EXPECT_THAT(merge_fault(), HasSubstr("was mapped with --no-loops, so nothing holds its path"));
}

// One sees from 0.5 to 8 m, and one from 0.1 m on as far as its sensor says: in the widest limits of both, each reading
// counts as it did.
TEST_F(MergedRunsTest, ShareTheWidestLimitsAndEachScanKeepsItsOwn) {
  const auto run_of = [](double min_m, double max_m, double sensor_m) {
    RunSession run = read_run_session(second_run());
    run.kept.keyframes.clear();
    run.settings.mapper.scan.min_range_m = min_m;
    run.settings.mapper.scan.max_range_m = max_m;
    RunKeyframe keyframe;
    keyframe.laser.max_range_m = sensor_m;
    keyframe.laser.bearing_step_rad = 0.01;
    keyframe.laser.ranges_m = {0.05F, 0.3F, 7.5F, 9.0F, 35.0F};
    run.kept.keyframes.push_back(keyframe);
    return run;
  };
  std::vector<RunSession> runs;
  runs.push_back(run_of(0.5, 8.0, 0.0));
  runs.push_back(run_of(0.1, 40.0, 30.0));
  std::vector<std::vector<Point2>> own;
  for (const RunSession& run : runs) {
    own.push_back(ScanPoints(run.settings.mapper.scan).of(run.kept.keyframes[0].laser));
  }
  ASSERT_EQ(own[0].size(), 1U);
  ASSERT_EQ(own[1].size(), 3U);
  share_range_limits(runs);
  for (std::size_t k = 0; k < 2; ++k) {
    const ScanConfig& scan = runs[k].settings.mapper.scan;
    EXPECT_EQ(scan.min_range_m, 0.1);
    EXPECT_EQ(scan.max_range_m, 40.0);
    EXPECT_EQ(ScanPoints(scan).of(runs[k].kept.keyframes[0].laser), own[k]) << k;
  }
  EXPECT_EQ(runs[0].kept.keyframes[0].laser.max_range_m, 8.0);
  EXPECT_EQ(runs[1].kept.keyframes[0].laser.max_range_m, 30.0);
  // Where one counts from nothing on, what is too near for the other stays out in the settings of either.
  std::vector<RunSession> from_nothing;
  from_nothing.push_back(run_of(0.0, 40.0, 30.0));
  from_nothing.push_back(run_of(0.5, 40.0, 30.0));
  share_range_limits(from_nothing);
  for (const RunSession& run : from_nothing) {
    EXPECT_EQ(ScanPoints(run.settings.mapper.scan).of(from_nothing[0].kept.keyframes[0].laser).size(), 4U);
    EXPECT_EQ(ScanPoints(run.settings.mapper.scan).of(from_nothing[1].kept.keyframes[0].laser).size(), 2U);
  }
}

}  // namespace
}  // namespace gdtslam
