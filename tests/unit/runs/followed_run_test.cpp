// Scans found and followed in the map of a run whose poses are known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/localizer/localize_log.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

using test::ring_run;

class FollowedRun : public testing::Test {
 protected:
  FollowedRun() { job_.log = ring_run().log; }

  const std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
  const MapperConfig config_;
  const LocalizeLimits limits_{.with_runner_up = false};
  Localizer localizer_{ring_run().folder, config_, limits_, *cpu_};
  LocalizeJob job_;
};

TEST_F(FollowedRun, ADriveIsFollowedToItsEnd) {
  job_.choice.first = 3;
  std::vector<Whereabouts> told;
  std::uint64_t done = 0;
  const TrackedDrive drive = track_drive(
      job_, localizer_, config_, *cpu_, [&](std::uint64_t scans, double) { done = scans; }, [] { return false; },
      [&](const LaserScan&, const TrackedPose& pose) { told.push_back(pose.whereabouts); });
  const std::size_t scans = ring_run().truth.size() - 3;
  ASSERT_EQ(drive.scans.size(), scans);
  EXPECT_EQ(drive.followed, scans);
  EXPECT_EQ(done, scans);
  EXPECT_EQ(told.size(), scans);
  EXPECT_EQ(drive.scans[0].index, 3U);
  EXPECT_EQ(drive.searches, 1U);
  EXPECT_EQ(drive.scans[0].pose.whereabouts, Whereabouts::kFound);
  EXPECT_EQ(drive.scans.back().pose.whereabouts, Whereabouts::kTracked);
  EXPECT_FALSE(drive.interrupted);
  EXPECT_EQ(count_whereabouts(drive)[0], 0U);
  for (const TrackedScan& scan : drive.scans) {
    EXPECT_LT((scan.pose.T_map_base.translation() - ring_run().truth[scan.index].translation()).norm(), 0.2);
  }
  DriveChanges changes(localizer_.field(), config_, {});
  TrackedPose sure{.whereabouts = Whereabouts::kTracked, .T_map_base = ring_run().truth[10], .covariance = {}};
  const LaserScan scan = RunReader(ring_run().folder).keyframes()->keyframes[10].laser;
  changes.see(scan, sure);
  sure.is_ambiguous = true;
  changes.see(scan, sure);  // ends the stretch
  sure.is_ambiguous = false;
  changes.see(scan, sure);
  sure.whereabouts = Whereabouts::kPredicted;
  changes.see(scan, sure);
  EXPECT_EQ(changes.stretches().size(), 2U);
  EXPECT_EQ(changes.stretches()[1].size(), 1U);
  EXPECT_TRUE(changes.found().empty()) << "the run saw the same";
}

// Whole cells round the scan and the map: two of them are a good fit however well the run's own scans fit.
TEST(FitLimit, IsTwoCellsAtLeast) {
  std::vector<double> own_m;
  for (int k = 100; k >= 0; --k) own_m.push_back(0.001 * k);
  const FitLimit fine = make_fit_limit(own_m, 0.01);
  EXPECT_EQ(fine.source, FitLimit::Source::kRun);
  EXPECT_DOUBLE_EQ(fine.distance_m, 0.099);
  EXPECT_DOUBLE_EQ(fine.usual_m, 0.050);
  const FitLimit coarse = make_fit_limit(own_m, 0.06);
  EXPECT_EQ(coarse.source, FitLimit::Source::kResolution);
  EXPECT_DOUBLE_EQ(coarse.distance_m, 0.12);
  EXPECT_DOUBLE_EQ(coarse.usual_m, 0.050) << "however coarse the cells are";
  const FitLimit alone = make_fit_limit({}, 0.03);
  EXPECT_EQ(alone.source, FitLimit::Source::kResolution);
  EXPECT_EQ(alone.distance_m, 0.06);
  EXPECT_EQ(alone.usual_m, 0.03);
}

TEST(DriveChanges, TheTableOfChangesHasCentresAndPlaces) {
  MapChanges changes;
  changes.appeared = {{.cell = {1, 2}, .views = {.ends = 3, .passes = 4}, .patch = 0}};
  changes.gone = {{.cell = {0, 0}, .views = {.ends = 0, .passes = 9}, .patch = 1}};
  EXPECT_EQ(changes_table({0.5, -1.0, 2.0, 4, 4}, changes),
            "x_m,y_m,change,place,ended,passed\n-0.2500,3.2500,new,1,3,4\n-0.7500,2.2500,gone,2,0,9\n");
}

}  // namespace
}  // namespace gdtslam
