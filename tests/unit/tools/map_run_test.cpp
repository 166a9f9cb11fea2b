// What a run says of its scans, in a room that is known in closed form.
#include "engine/runs/drive/map_run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "engine/io/logs/carmen_writer.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "support/nodding_drive.hpp"

namespace gdtslam {
namespace {

// The wheels stand still, but the third scan is turned by 0.012 rad: the pose stays, the match does not.
TEST(MapRun, ADoubtIsAboutTheMatchWhereTheRobotRests) {
  test::NoddingDrive drive;
  drive.beams = 721;
  drive.T_room_base = [](double t) { return Pose2{0.0, 0.0, t < 0.075 ? 0.0 : 0.012}; };
  const std::string log = std::filesystem::temp_directory_path() / ("gdtslam-rest-" + std::to_string(::getpid()));
  {
    std::ofstream file(log);
    CarmenWriter writer(6);
    for (std::size_t k = 0; k < 3; ++k) {
      NoddingScan scan = test::scan_of(drive, k);
      scan.record.T_odom_base = Pose2{};
      file << writer.scan(scan.record) << "TILT 0 " << scan.record.scan.stamp_s << " robot 0\n";
    }
  }
  MapRequest job{.logs = {log}, .with_loops = false};
  job.settings.mapper.doubt.report_rad = 0.006;
  NoddingJob nodding;
  nodding.kind = NodKind::kTilt;
  nodding.model = calib::sweep_model_of_preset(calib::kDefaultLinkage);
  nodding.model.mirror_rate_hz = 0.0;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapRun run(job, *cpu, ScanStream(job.logs, {}, {}), &nodding);
  const MapOutcome outcome = run.run([](std::uint64_t, double) {}, [] { return false; });
  std::filesystem::remove(log);
  ASSERT_EQ(outcome.doubtful.size(), 1U);
  const DoubtfulScan& doubt = outcome.doubtful.front();
  EXPECT_EQ(doubt.reason, Doubt::kFarFromPrediction);
  EXPECT_NEAR(doubt.from_prediction_rad, 0.012, 0.003);
  EXPECT_EQ(outcome.trajectory[doubt.index].T_map_base, outcome.trajectory[0].T_map_base);
}

}  // namespace
}  // namespace gdtslam
