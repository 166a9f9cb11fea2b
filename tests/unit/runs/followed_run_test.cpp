// Scans found and followed in the map of a run whose poses are known; what drives add up to, by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/localizer/drive.hpp"
#include "engine/runs/localizer/drive_changes.hpp"
#include "engine/runs/localizer/drive_figures.hpp"
#include "engine/runs/localizer/reference.hpp"
#include "engine/runs/localizer/scans.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

using test::ring_run;
using testing::HasSubstr;

class FollowedRun : public testing::Test {
 protected:
  FollowedRun() { job_.log = ring_run().log; }
  [[nodiscard]] Localized localized() {
    return localize_scans(
        job_, localizer_, [](std::uint64_t, double) {}, [] { return false; });
  }
  [[nodiscard]] std::string localize_fault() {
    try {
      static_cast<void>(localized());
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  const std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
  const MapperConfig config_;
  const LocalizeLimits limits_{.with_runner_up = false};
  Localizer localizer_{ring_run().folder, config_, limits_, *cpu_};
  LocalizeJob job_;
};

TEST_F(FollowedRun, ScansAreFoundWhereTheyWere) {
  job_.reference.emplace(ring_run().folder + "/trajectory.tum");
  job_.choice = {.first = 5, .every = 90};
  const Localized found = localized();
  const std::size_t scans = ring_run().truth.size();
  ASSERT_EQ(found.scans.size(), (scans - 5 + 89) / 90);
  EXPECT_EQ(found.candidates, found.scans.size());
  EXPECT_FALSE(found.nods);
  for (std::size_t k = 0; k < found.scans.size(); ++k) {
    const LocalizedScan& scan = found.scans[k];
    EXPECT_EQ(scan.index, 5 + 90 * k);
    ASSERT_TRUE(scan.best && scan.reference) << k;
    EXPECT_EQ(scan.verdict, Verdict::kFound);
    EXPECT_TRUE(scan.reference->is_within);
    EXPECT_LT(scan.reference->distance_m, 0.1);
    EXPECT_LT(scan.reference->angle_rad, rad_from_deg(1.0));
    EXPECT_GT(scan.reference->known_share, 0.9);
    const Pose2& truth = ring_run().truth[scan.index];
    EXPECT_LT((scan.best->T_map_base.translation() - truth.translation()).norm(), 0.15);
  }
}

TEST_F(FollowedRun, ScansAreChosenAsAsked) {
  job_.choice = {.first = 7};
  ASSERT_EQ(localized().scans.size(), 1U);
  EXPECT_EQ(localized().scans[0].index, 7U);
  job_.choice = {.random = 3, .seed = 11};
  const Localized drawn = localized();
  ASSERT_EQ(drawn.scans.size(), 3U);
  EXPECT_LT(drawn.scans[0].index, drawn.scans[1].index);
  EXPECT_LT(drawn.scans[1].index, drawn.scans[2].index);
  EXPECT_EQ(drawn.candidates, ring_run().truth.size());
  job_.threads = 2;
  const Localized by_threads = localized();
  ASSERT_EQ(by_threads.scans.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(by_threads.scans[k].index, drawn.scans[k].index);
    EXPECT_EQ(by_threads.scans[k].best->T_map_base, drawn.scans[k].best->T_map_base);
  }
  job_.choice = {.first = 100'000};
  EXPECT_THAT(localize_fault(),
              HasSubstr("has no scan 100000: " + std::to_string(ring_run().truth.size()) + " were read"));
}

TEST_F(FollowedRun, ScansNearTheMapsOwnDoNotCount) {
  const RunReader run(ring_run().folder);
  const std::size_t kept = run.summary().keyframes.size();
  job_.merged.emplace(run, 0.0);
  EXPECT_EQ(job_.merged->count(), kept);
  EXPECT_EQ(near_text(*job_.merged), "that went into the map");
  const double stamp_s = 1000.0 + 0.5 * static_cast<double>(run.summary().keyframes[3]);
  EXPECT_TRUE(job_.merged->are_near(stamp_s));
  EXPECT_FALSE(job_.merged->are_near(stamp_s + 0.001));
  EXPECT_FALSE(job_.merged->are_near(1e9));
  const MergedScans wide(run, 0.25);
  EXPECT_EQ(near_text(wide), "within 0.25 s of one that went into the map");
  EXPECT_TRUE(wide.are_near(stamp_s + 0.25) && wide.are_near(stamp_s - 0.25));
  EXPECT_FALSE(wide.are_near(999.74));
  EXPECT_TRUE(wide.are_near(999.75));
  job_.merged.emplace(run, 1e6);
  job_.choice = {.every = 1};
  EXPECT_THAT(localize_fault(), HasSubstr("has no scan left to localise; left out: " +
                                          std::to_string(ring_run().truth.size()) + " within 1e+06 s of one that"));
}

TEST_F(FollowedRun, AReferenceInAnotherFrameIsLaidOnTheRun) {
  const test::RunsFolder folder("truth");
  Trajectory elsewhere;
  const Pose2 T_other_map{100.0, -20.0, 2.0};
  for (std::size_t k = 0; k < ring_run().truth.size(); ++k) {
    elsewhere.push_back({1000.0 + 0.5 * static_cast<double>(k), T_other_map * ring_run().truth[k]});
  }
  write_tum(folder.path("truth.tum"), elsewhere);
  LocalizeTruth truth(folder.path("truth.tum"));
  EXPECT_FALSE(truth.is_aligned());
  EXPECT_NEAR(truth.find(1000.0)->x_m, 100.0, 1e-5);
  truth.align(RunReader(ring_run().folder));
  EXPECT_TRUE(truth.is_aligned());
  for (std::size_t k = 0; k < ring_run().truth.size(); k += 40) {
    const Pose2 found = truth.find(1000.0 + 0.5 * static_cast<double>(k)).value();
    EXPECT_LT((found.translation() - ring_run().truth[k].translation()).norm(), 0.1);
    EXPECT_LT(std::fabs(wrap_angle(found.theta_rad - ring_run().truth[k].theta_rad)), 0.01);
  }
  EXPECT_FALSE(truth.find(1000.25));
}

TEST_F(FollowedRun, AReferenceTellsNothingOfStampsThatItHasTwice) {
  const test::RunsFolder folder("twice");
  write_tum(folder.path("truth.tum"), {{1000.0, {}}, {1001.0, {}}, {1002.0, {}}, {1000.0, {3.0, 0.0, 0.0}}});
  const LocalizeTruth truth(folder.path("truth.tum"));
  EXPECT_EQ(truth.count_repeated(), 2U);
  EXPECT_FALSE(truth.find(1000.0));
  EXPECT_TRUE(truth.find(1001.0));
}

TEST_F(FollowedRun, ADriveIsFollowedToItsEnd) {
  job_.reference.emplace(ring_run().folder + "/trajectory.tum");
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
  EXPECT_TRUE(drive.scans[0].is_searched);
  EXPECT_EQ(drive.scans[0].pose.whereabouts, Whereabouts::kFound);
  EXPECT_EQ(drive.scans.back().pose.whereabouts, Whereabouts::kTracked);
  EXPECT_FALSE(drive.scans.back().is_searched);
  EXPECT_FALSE(drive.interrupted);
  const DriveFigures figures = figures_of(drive);
  EXPECT_EQ(figures.within.of, scans);
  EXPECT_GT(figures.within.value(), 0.98);
  EXPECT_LT(figures.distance_m.max, 0.1);
  EXPECT_EQ(figures.whereabouts[0], 0U);
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

TEST_F(FollowedRun, ADriveThatIsStoppedOrEmpty) {
  int asked = 0;
  const TrackedDrive drive = track_drive(
      job_, localizer_, config_, *cpu_, [](std::uint64_t, double) {}, [&] { return ++asked > 4; });
  EXPECT_TRUE(drive.interrupted);
  EXPECT_EQ(drive.followed, 4U);
  job_.choice.first = 100'000;
  try {
    track_drive(
        job_, localizer_, config_, *cpu_, [](std::uint64_t, double) {}, [] { return false; });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no scan 100000"));
  }
}

// Whole cells round the scan and the map: two of them are a good fit however well the run's own scans fit.
TEST(FitLimit, IsTwoCellsAtLeast) {
  std::vector<double> own_m;
  for (int k = 100; k >= 0; --k) own_m.push_back(0.001 * k);
  const FitLimit fine = fit_limit_of(own_m, 0.01);
  EXPECT_EQ(fine.source, FitLimit::Source::kRun);
  EXPECT_DOUBLE_EQ(fine.distance_m, 0.099);
  EXPECT_DOUBLE_EQ(fine.usual_m, 0.050);
  const FitLimit coarse = fit_limit_of(own_m, 0.06);
  EXPECT_EQ(coarse.source, FitLimit::Source::kResolution);
  EXPECT_DOUBLE_EQ(coarse.distance_m, 0.12);
  EXPECT_DOUBLE_EQ(coarse.usual_m, 0.050) << "however coarse the cells are";
  const FitLimit alone = fit_limit_of({}, 0.03);
  EXPECT_EQ(alone.source, FitLimit::Source::kResolution);
  EXPECT_EQ(alone.distance_m, 0.06);
  EXPECT_EQ(alone.usual_m, 0.03);
}

TEST(FitLimit, IsThatOfTheScansInTheFinishedMap) {
  const std::string& folder = ring_run().folder;
  const auto cpu = make_cpu_backend({});
  const Localizer in_run(folder, MapperConfig{}, {}, *cpu);
  const Localizer in_field(folder + "/gdt.yaml", MapperConfig{}, {}, *cpu);
  EXPECT_GT(in_run.good_fit().usual_m, 0.0);
  EXPECT_LT(in_run.good_fit().usual_m, 0.025) << "walls without noise, rounded to cells of 25 mm";
  EXPECT_EQ(in_run.good_fit().usual_m, in_field.good_fit().usual_m);
  EXPECT_EQ(run_of_map(folder + "/gdt.yaml", "--align").folder(), folder);
  EXPECT_THROW(run_of_map("/gdtslam/nowhere/gdt.yaml", "--align"), InputError);
}

TrackedScan tracked(std::uint64_t index, Whereabouts whereabouts, std::optional<TrackReference> reference = {}) {
  TrackedScan scan;
  scan.index = index;
  scan.stamp_s = 10.0 * static_cast<double>(index);
  scan.pose.whereabouts = whereabouts;
  scan.pose.covariance = {.xx = 0.04, .yy = 0.01, .tt = 0.0001};
  scan.wall_s = 0.001 * static_cast<double>(index + 1);
  scan.reference = reference;
  return scan;
}

TEST(DriveFigures, AddUpByHand) {
  const TrackReference right{
      .T_map_base = {0.1, 0.0, 0.0}, .distance_m = 0.1, .angle_rad = kPi, .is_within = true, .is_mapped = true};
  const TrackReference wrong{.T_map_base = {}, .distance_m = 5.0, .is_within = false, .is_mapped = true};
  const TrackReference unmapped{.T_map_base = {}, .is_within = true, .is_mapped = false};
  TrackedDrive drive;
  drive.scans = {tracked(0, Whereabouts::kUnknown, wrong),
                 tracked(1, Whereabouts::kUnknown),
                 tracked(2, Whereabouts::kFound, right),
                 tracked(3, Whereabouts::kTracked, right),
                 tracked(4, Whereabouts::kPredicted, right),
                 tracked(5, Whereabouts::kTracked, wrong),
                 tracked(6, Whereabouts::kTracked, unmapped),
                 tracked(7, Whereabouts::kUnknown),
                 tracked(8, Whereabouts::kUnknown)};
  drive.scans[2].is_searched = true;
  drive.scans[3].pose.is_ambiguous = true;
  drive.scans[8].is_searched = true;
  const DriveFigures figures = figures_of(drive);
  EXPECT_EQ(figures.whereabouts, (std::array<std::uint64_t, 4>{4, 1, 3, 1}));
  EXPECT_EQ(figures.ambiguous, 1U);
  EXPECT_EQ(figures.searches, 2U);
  EXPECT_EQ(figures.within.of, 5U);
  EXPECT_EQ(figures.within.count, 3U);
  EXPECT_EQ(figures.unmapped, 1U);
  EXPECT_EQ(figures.without, 1U);
  EXPECT_EQ(figures.off, 1U);
  EXPECT_EQ(figures.distance_m.count, 3U);
  EXPECT_NEAR(figures.angle_deg.mean, 180.0, 1e-9);
  // 10 cm along x at 20 cm of deviation: a quarter, of the two that were matched.
  EXPECT_EQ(figures.squared_sigmas.count, 2U);
  EXPECT_NEAR(figures.squared_sigmas.mean, 0.25, 1e-9);
  ASSERT_EQ(figures.stretches.size(), 2U);
  EXPECT_EQ(figures.stretches[0].first, 0U);
  EXPECT_EQ(figures.stretches[0].scans, 2U);
  EXPECT_EQ(figures.stretches[0].lasted_s, 20.0);
  EXPECT_TRUE(figures.stretches[0].is_found);
  EXPECT_EQ(figures.stretches[1].first, 7U);
  EXPECT_EQ(figures.stretches[1].scans, 2U);
  EXPECT_EQ(figures.stretches[1].lasted_s, 10.0) << "up to the last scan";
  EXPECT_FALSE(figures.stretches[1].is_found);
  const StepTimes searched = times_of(drive, true);
  EXPECT_EQ(searched.count, 2U);
  EXPECT_DOUBLE_EQ(searched.max_s, 0.009);
  const StepTimes others = times_of(drive, false);
  EXPECT_EQ(others.count, 7U);
  EXPECT_DOUBLE_EQ(others.median_s, 0.005);
  EXPECT_DOUBLE_EQ(others.max_s, 0.008);
  EXPECT_EQ(times_of({}, true).count, 0U);
}

TEST(DriveFigures, TheTableHasALineAScan) {
  TrackedDrive drive;
  drive.scans = {
      tracked(4, Whereabouts::kUnknown),
      tracked(5, Whereabouts::kTracked, TrackReference{.T_map_base = {1.0, -2.0, 0.5}, .known_share = 0.75})};
  drive.scans[1].pose.T_map_base = {3.0, 4.0, -1.0};
  drive.scans[1].pose.explained = 0.9;
  drive.scans[1].pose.mean_distance_m = 0.0125;
  drive.scans[1].pose.is_ambiguous = true;
  const std::string text = table_text(drive);
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "4,40.000000000,unknown,0,,,,,,,,,,,,,,,\n"
            "5,50.000000000,tracked,1,3.000000,4.000000,-1.00000000,0.04,0,0,0.01,0,0.0001,0.9000,0.01250,"
            "1.000000,-2.000000,0.50000000,0.7500\n");
  const std::string names = text.substr(0, text.find('\n'));
  EXPECT_EQ(std::count(names.begin(), names.end(), ','), 18);
}

TEST(DriveFigures, TheTableOfChangesHasCentresAndPlaces) {
  MapChanges changes;
  changes.appeared = {{.cell = {1, 2}, .views = {.ends = 3, .passes = 4}, .patch = 0}};
  changes.gone = {{.cell = {0, 0}, .views = {.ends = 0, .passes = 9}, .patch = 1}};
  EXPECT_EQ(changes_table({0.5, -1.0, 2.0, 4, 4}, changes),
            "x_m,y_m,change,place,ended,passed\n-0.2500,3.2500,new,1,3,4\n-0.7500,2.2500,gone,2,0,9\n");
}

}  // namespace
}  // namespace gdtslam
