// Tables of poses that were found: what `localize` writes is what `evaluate` reads, and how many of them are right.
#include "engine/runs/evaluation/pose_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

std::string written(const test::RunsFolder& folder, const std::string& text) {
  const std::string path = folder.path("poses.csv");
  std::ofstream(path) << text;
  return path;
}

CertifiedResult result_of(double mean_cost_m, CertifiedStop stop = CertifiedStop::kGapReached) {
  CertifiedResult result;
  result.mean_cost_m = mean_cost_m;
  result.stop = stop;
  return result;
}

TrackedScan tracked(std::uint64_t index, Whereabouts whereabouts, const Pose2& T_map_base = {}) {
  return {.index = index,
          .stamp_s = 10.0 * static_cast<double>(index),
          .pose = {.whereabouts = whereabouts,
                   .T_map_base = T_map_base,
                   .explained = 0.9,
                   .mean_distance_m = 0.0125,
                   .covariance = {.xx = 0.04, .yy = 0.01, .tt = 0.0001}}};
}

TEST(PoseTable, OfADriveIsReadAsItWasWritten) {
  const test::RunsFolder folder("drive-table");
  TrackedDrive drive;
  drive.scans = {tracked(4, Whereabouts::kUnknown), tracked(5, Whereabouts::kTracked, {3.0, 4.0, -1.0})};
  drive.scans[1].pose.is_ambiguous = true;
  const std::string text = table_text(drive);
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "4,40.000000000,unknown,0,,,,,,,,,,,\n"
            "5,50.000000000,tracked,1,3.000000,4.000000,-1.00000000,0.04,0,0,0.01,0,0.0001,0.9000,0.01250\n");
  EXPECT_EQ(count_whereabouts(drive), (std::array<std::uint64_t, 4>{1, 0, 1, 0}));
  const std::string path = written(folder, text);
  EXPECT_TRUE(is_pose_table(path));
  const std::vector<FoundPose> poses = read_pose_table(path);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].state, "unknown");
  EXPECT_FALSE(poses[0].T_map_base || poses[0].covariance);
  EXPECT_EQ(poses[1].scan, 5U);
  EXPECT_EQ(poses[1].stamp_s, 50.0);
  EXPECT_TRUE(poses[1].is_ambiguous);
  EXPECT_EQ(poses[1].T_map_base, (Pose2{3.0, 4.0, -1.0}));
  ASSERT_TRUE(poses[1].covariance);
  EXPECT_EQ(poses[1].covariance->yy, 0.01);
}

TEST(PoseTable, OfSingleScansIsReadAsItWasWritten) {
  const test::RunsFolder folder("scan-table");
  LocalizedScan found;
  found.index = 7;
  found.points = 180;
  found.best = result_of(0.02);
  found.best->T_map_base = {1.0, 2.0, 0.5};
  found.verdict = Verdict::kFound;
  LocalizedScan empty;
  empty.index = 8;
  const std::string text = table_text(std::vector{found, empty});
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "7,0.000000000,found,0,1.000000,2.000000,0.50000000,180,0.02000,0.00000,1,,,,\n"
            "8,0.000000000,no-pose,0,,,,0,,,0,,,,\n");
  EXPECT_EQ(count_verdicts({found, empty}), (std::array<std::uint64_t, 4>{1, 0, 0, 1}));
  const std::vector<FoundPose> poses = read_pose_table(written(folder, text));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].T_map_base, (Pose2{1.0, 2.0, 0.5}));
  EXPECT_FALSE(poses[0].covariance);
  EXPECT_EQ(poses[1].state, "no-pose");
}

FoundPose pose_at(std::uint64_t scan, const std::string& state, const Pose2& T_map_base) {
  return {.scan = scan, .stamp_s = static_cast<double>(scan), .state = state, .T_map_base = T_map_base};
}

TEST(ComparePoses, CountsWhatIsRightByState) {
  const Pose2 T_truth_map{10.0, 0.0, kPi / 2};
  Trajectory truth;
  for (int k = 0; k < 6; ++k) truth.push_back({static_cast<double>(k), T_truth_map * Pose2{1.0 * k, 0.0, 0.0}});
  truth.push_back({2.0, {}});  // the clock stepped back: the stamp 2 says nothing
  std::vector<FoundPose> poses{pose_at(0, "found", {0.05, 0.0, 0.0}), pose_at(1, "found", {1.0, 0.0, 0.1}),
                               pose_at(2, "found", {2.0, 0.0, 0.0}), pose_at(3, "ambiguous", {3.0, -0.09, 0.0}),
                               pose_at(9, "found", {})};
  poses.push_back({.scan = 4, .stamp_s = 4.0, .state = "no-pose"});
  poses[3].covariance = PoseCovariance{.xx = 0.01, .yy = 0.01, .tt = 0.01};
  const PosesReport report = compare_poses(poses, truth, T_truth_map, {});
  EXPECT_EQ(report.within.count, 2U);
  EXPECT_EQ(report.within.of, 4U);
  EXPECT_EQ(report.unmatched, 2U);
  EXPECT_EQ(report.states.at("found").of, 2U);
  EXPECT_EQ(report.states.at("ambiguous").count, 1U);
  EXPECT_NEAR(report.distance_m.max, 0.09, 1e-12);
  ASSERT_EQ(report.wrong.size(), 2U);
  EXPECT_EQ(report.wrong[0].scan, 1U);
  EXPECT_NEAR(report.wrong[0].error->angle_deg, deg_from_rad(0.1), 1e-9);
  EXPECT_FALSE(report.wrong[1].error);
  ASSERT_TRUE(report.stated);
  EXPECT_EQ(report.stated->pose.count, 1U);
  EXPECT_EQ(report.stated->pose.within[0], 1U) << "nine tenths of a standard deviation to the side";
  EXPECT_THROW(static_cast<void>(compare_poses({pose_at(77, "found", {})}, truth, {}, {})), InputError);
}

TEST(ComparePoses, LeavesOutWhatIsNearInTime) {
  const std::vector<FoundPose> poses{pose_at(0, "found", {}), pose_at(1, "found", {}), pose_at(2, "found", {})};
  EXPECT_EQ(without_near(poses, {2.0, 0.0}, 0.0).size(), 1U);
  EXPECT_EQ(without_near(poses, {2.5}, 0.5).size(), 2U);
  EXPECT_TRUE(without_near(poses, {1.0}, 1.0).empty());
}

TEST(LocalizeVerdict, IsOfTheFitAndThePosesElsewhere) {
  LocalizedScan scan;
  scan.best = result_of(0.020);
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  EXPECT_EQ(verdict_of(scan, 0.0199), Verdict::kPoorFit);
  scan.best->stop = CertifiedStop::kTimeLimit;  // the proof is another matter
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  scan.best->cost = 100;
  scan.runner_up = result_of(0.021);
  scan.runner_up->bound = 101;
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  scan.as_good = 1;
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kAmbiguous);
  EXPECT_EQ(verdict_of(scan, 0.01), Verdict::kPoorFit) << "wherever else it may fit as poorly";
  scan.best.reset();
  EXPECT_EQ(verdict_of(scan, 1.0), Verdict::kNoPose);
}

}  // namespace
}  // namespace gdtslam
