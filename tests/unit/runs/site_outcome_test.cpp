// What a site has of its runs: paths that follow their keyframes, counts, doubts and the graph, all by hand.
#include "engine/runs/sites/site_outcome.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/pose_matchers.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

void expect_pose(const Pose2& found, double x_m, double y_m, double theta_rad) {
  EXPECT_NEAR(found.x_m, x_m, 1e-12);
  EXPECT_NEAR(found.y_m, y_m, 1e-12);
  EXPECT_NEAR(wrap_angle(found.theta_rad - theta_rad), 0.0, 1e-12);
}

class SiteOutcomeTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // Five scans a second apart along x, one metre from one to the next; keyframes are scans 0, 2 and 4.
  [[nodiscard]] RunSession run(const std::string& name, double begin_s, const std::string& more) const {
    fs::create_directories(folder_ / name);
    std::ofstream(folder_ / name / "report.json") << R"({"format": 1, "map_sha256": "")" << more << '}';
    RunSession session{.folder = (folder_ / name).string(),
                       .name = name,
                       .keyframes_sha256 = name,
                       .settings = {},
                       .trajectory = {},
                       .drives = {},
                       .kept = {},
                       .session = {},
                       .files = RunFiles((folder_ / name).string())};
    for (int k = 0; k < 5; ++k) session.trajectory.push_back({begin_s + k, {static_cast<double>(k), 0.0, 0.0}});
    for (const std::size_t scan : {0U, 2U, 4U}) {
      RunKeyframe keyframe;
      keyframe.scan = scan;
      keyframe.T_map_base = session.trajectory[scan].T_map_base;
      keyframe.laser.stamp_s = session.trajectory[scan].stamp_s;
      session.kept.keyframes.push_back(keyframe);
    }
    return session;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-site-" + std::to_string(::getpid()));
};

TEST_F(SiteOutcomeTest, ScansLieBetweenTheirKeyframes) {
  const RunSession session = run("a", 0.0, "");
  // The second keyframe is moved to the side by 0.4 m, the third turned by 0.2 rad where it is.
  const Trajectory path = trajectory_in_site(session, {{10.0, 5.0, 0.0}, {12.0, 5.4, 0.0}, {14.0, 5.0, 0.2}});
  ASSERT_EQ(path.size(), 5U);
  expect_pose(path[0].T_map_base, 10.0, 5.0, 0.0);
  expect_pose(path[1].T_map_base, 11.0, 5.2, 0.0);  // half of the way to what the second one makes of it
  expect_pose(path[2].T_map_base, 12.0, 5.4, 0.0);
  expect_pose(path[4].T_map_base, 14.0, 5.0, 0.2);
  EXPECT_EQ(path[3].stamp_s, 3.0);
  // By the second: (13, 5.4, 0); by the third (14 - cos 0.2, 5 - sin 0.2, 0.2). Half of the arc from one to the other.
  const Pose2 by_second{13.0, 5.4, 0.0};
  const Pose2 by_third{14.0 - std::cos(0.2), 5.0 - std::sin(0.2), 0.2};
  const Pose2 middle = by_second * exp_se2(0.5 * log_se2(between(by_second, by_third)));
  expect_pose(path[3].T_map_base, middle.x_m, middle.y_m, 0.1);
}

MergedSite site_of_two_runs() {
  MergedSite site;
  site.sessions = {0, 1};
  site.poses = {{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {4.0, 0.0, 0.0}},
                {{0.0, 9.0, 0.0}, {2.0, 9.0, 0.0}, {4.0, 9.0, 0.0}}};
  site.searches = 7;
  site.joint.pairs = 11;
  site.joint.rms_m = 0.02;
  site.places = {0, 2, 3, 5};
  site.graph.poses = {{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 9.0, 0.0}, {4.0, 9.0, 0.0}};
  const Matrix3 information{{1.0, 2.0, 3.0, 2.0, 5.0, 6.0, 3.0, 6.0, 9.0}};
  site.graph.path = {{0, 1, {4.0, 0.0, 0.0}, information}};
  // The pose in the graph is (4, 9, 0) of the first place: 0.3 m and 0.4 m off in its own frame, and turned by 0.25.
  site.graph.loops = {{{0, 3, {3.7, 8.6, 0.0}, information}, 0.5}, {{1, 2, {-4.0, 9.0, -0.25}, information}, 0.25}};
  for (int k = 0; k < 6; ++k) site.covariances.push_back(Matrix3::diagonal(k + 1.0, 2.0, 3.0));
  return site;
}

// The first run is named "a" and has a doubt, the second "b" one of a kind that nobody knows.
class SiteOfTwoRuns : public SiteOutcomeTest {
 protected:
  [[nodiscard]] MapOutcome outcome() const {
    const RunSession first = run("a", 100.0, R"(, "matched": 4, "doubtful": 1, "restarts": 2, "doubtful_scans": [
        {"index": 3, "stamp_s": 103.0, "reason": "low-overlap", "accepted": false, "from_prediction_m": 0.5,
         "from_prediction_deg": 90.0}])");
    const RunSession second = run("b", 50.0, R"(, "matched": 5, "doubtful": 2, "restarts": 1, "doubtful_scans": [
        {"index": 0, "stamp_s": 50.0, "reason": "of-another-version", "accepted": true, "from_prediction_m": 0.25,
         "from_prediction_deg": 0.0}])");
    const MergedSite site = site_of_two_runs();
    const std::vector<const RunSession*> runs{&first, &second};
    std::vector<Trajectory> paths;
    for (std::size_t k = 0; k < 2; ++k) paths.push_back(trajectory_in_site(*runs[k], site.poses[k]));
    return site_outcome(site, runs, paths);
  }
};

TEST_F(SiteOfTwoRuns, TheyFollowOneAnotherAndAddUp) {
  const MapOutcome outcome = this->outcome();
  EXPECT_EQ(outcome.trajectory.size(), 10U);
  EXPECT_EQ(outcome.drives, (std::vector<std::size_t>{5}));
  EXPECT_EQ(outcome.keyframes, (std::vector<std::size_t>{0, 2, 4, 5, 7, 9}));
  ASSERT_EQ(outcome.keyframe_scans.size(), 6U);
  EXPECT_EQ(outcome.keyframe_scans[4].stamp_s, 52.0);
  EXPECT_EQ(outcome.statistics.scans, 10U);
  EXPECT_EQ(outcome.statistics.matched, 9U);
  EXPECT_EQ(outcome.statistics.doubtful, 3U);
  EXPECT_EQ(outcome.statistics.keyframes, 6U);
  EXPECT_EQ(outcome.statistics.restarts, 3U);
  EXPECT_NEAR(outcome.statistics.path_m, 8.0, 1e-9);
  EXPECT_NEAR(outcome.log_duration_s, 8.0, 1e-9);
  ASSERT_EQ(outcome.doubtful.size(), 2U);
  EXPECT_EQ(outcome.doubtful[0].index, 3U);
  EXPECT_EQ(outcome.doubtful[0].reason, Doubt::kLowOverlap);
  EXPECT_FALSE(outcome.doubtful[0].accepted);
  EXPECT_EQ(outcome.doubtful[0].from_prediction_m, 0.5);
  EXPECT_NEAR(outcome.doubtful[0].from_prediction_rad, 0.5 * kPi, 1e-12);
  EXPECT_EQ(outcome.doubtful[1].index, 5U);
  EXPECT_EQ(outcome.doubtful[1].stamp_s, 50.0);
  EXPECT_EQ(outcome.doubtful[1].reason, Doubt::kWeakEvidence) << "a reason that is not known";
  EXPECT_TRUE(outcome.doubtful[1].accepted);
}

// The first run is a site of two drives, a day and 96 m apart.
TEST_F(SiteOutcomeTest, WhatLiesBetweenTheDrivesOfARunIsNotDriven) {
  const std::string counts = R"(, "matched": 5, "doubtful": 0, "restarts": 0, "doubtful_scans": [])";
  RunSession two = run("a", 100.0, counts);
  two.drives = {3};
  for (std::size_t k : {3U, 4U}) {
    two.trajectory[k].stamp_s += 86400.0;
    two.trajectory[k].T_map_base.y_m = 96.0;
  }
  const RunSession one = run("b", 50.0, counts);
  const MapOutcome outcome = site_outcome(site_of_two_runs(), {&two, &one}, {two.trajectory, one.trajectory});
  EXPECT_EQ(outcome.drives, (std::vector<std::size_t>{3, 5}));
  EXPECT_NEAR(outcome.statistics.path_m, 2.0 + 1.0 + 4.0, 1e-9);
  EXPECT_NEAR(outcome.log_duration_s, 2.0 + 1.0 + 4.0, 1e-9);
}

TEST_F(SiteOfTwoRuns, TheGraphCountsAllTheirScans) {
  const MapOutcome outcome = this->outcome();
  ASSERT_TRUE(outcome.closed);
  const ClosedPath& closed = *outcome.closed;
  EXPECT_TRUE(closed.is_closed);
  EXPECT_EQ(closed.searches, 7U);
  EXPECT_EQ(closed.pairs, 11U);
  EXPECT_EQ(closed.rms_m, 0.02);
  ASSERT_EQ(closed.places.size(), 4U);
  EXPECT_EQ(closed.places[1].scan, 4U);
  EXPECT_EQ(closed.places[2].scan, 5U);
  expect_pose(closed.places[3].T_map_base, 4.0, 9.0, 0.0);
  ASSERT_EQ(closed.path.size(), 1U);
  EXPECT_EQ(closed.path[0].to, 4U);
  const PoseInformation& told = closed.path[0].information;
  EXPECT_EQ((std::vector<double>{told.xx, told.xy, told.xt, told.yy, told.yt, told.tt}),
            (std::vector<double>{1.0, 2.0, 3.0, 5.0, 6.0, 9.0}));
  ASSERT_EQ(closed.loops.size(), 2U);
  EXPECT_EQ(closed.loops[0].from, 0U);
  EXPECT_EQ(closed.loops[0].to, 9U);
  EXPECT_NEAR(closed.loops[0].off_m, 0.5, 1e-9);
  EXPECT_NEAR(closed.loops[0].off_rad, 0.0, 1e-12);
  EXPECT_TRUE(closed.loops[0].is_on);
  EXPECT_EQ(closed.loops[0].weight, 0.5);
  EXPECT_NEAR(closed.loops[1].off_rad, 0.25, 1e-12);
  EXPECT_FALSE(closed.loops[1].is_on) << "a quarter is not more than a quarter";
  // Of the keyframe at or before each scan.
  std::vector<double> of_scans;
  for (const PoseCovariance& covariance : closed.covariances) of_scans.push_back(covariance.xx);
  EXPECT_EQ(of_scans, (std::vector<double>{1.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 6.0}));
  EXPECT_EQ(closed.covariances[9].yy, 2.0);
  EXPECT_EQ(closed.covariances[9].tt, 3.0);
}

}  // namespace
}  // namespace gdtslam
