// Runs with different limits of their ranges, joined.
#include <gtest/gtest.h>

#include <vector>

#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

using test::ring_run;

// One sees from 0.5 to 8 m, and one from 0.1 m on as far as its sensor says: in the widest limits of both, each reading
// counts as it did.
TEST(MergedRuns, ShareTheWidestLimitsAndEachScanKeepsItsOwn) {
  const auto run_of = [](double min_m, double max_m, double sensor_m) {
    RunSession run = read_run_session(ring_run().folder);
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
