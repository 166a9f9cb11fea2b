// The log and the linkage beside it, read back and put together by the closed forms, give the true hits.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include <gtest/gtest.h>

#include <cmath>

#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/core/nodding.hpp"
#include "simulate_nodding_fixture.hpp"

namespace gdtslam {
namespace {

constexpr const char* kStanding = R"(gdtslam_scene: 1
walls:
  - {points: [[-3, -2], [4, -2.5], [5, 2], [-2, 3]], closed: true, thickness: 10 cm, height: 2.5}
boxes:
  - {centre: [2, 0.4], size: [0.5, 0.7], height: 0.8, yaw: 20 deg}
floor: 0
ceiling: 2.5
robot:
  laser: {preset: hokuyo-961, drop_outs: 0, noise: 0, mount: {x: 10 cm, yaw: 3 deg}}
  nodding: {crank_rate: 0.1973, lever: {forward: 4 cm, up: 3 cm}, sensor: {roll: 1 deg}}
recording: {scan_rate: 40, odometry_rate: 10}
waypoints: [{at: [0.5, 0.25], pause: 5.2 s}]
)";

// The phase at a time between knots; the crank turns less than half a turn between two.
Phase phase_at(const std::vector<PhaseKnot>& knots, double offset_s) {
  std::size_t next = 1;
  while (next + 1 < knots.size() && knots[next].offset_s < offset_s) ++next;
  const PhaseKnot& a = knots[next - 1];
  const PhaseKnot& b = knots[next];
  const double ahead = static_cast<double>(static_cast<std::int32_t>(b.phase - a.phase));
  const double share = (offset_s - a.offset_s) / (b.offset_s - a.offset_s);
  return a.phase + static_cast<Phase>(static_cast<std::int64_t>(std::llround(ahead * share)));
}

struct Miss {
  double most_m = 0.0;
  double most_of_bound = 0.0;
  std::size_t points = 0;
};

// What a reader makes of the files alone (log and linkage), against the true hits.
Miss reconstructed(const std::vector<Encoder>& told, const std::vector<LaserScan>& measured,
                   const calib::SweepModel& model, const std::vector<HitRow>& hits, double resolution_m) {
  calib::NodTrack track(model.encoder, {});
  for (const Encoder& message : told) track.take(message);
  const ElevationTable table = calib::elevation_table(model);
  const double bound_at_1_m = calib::quantisation_bound_m(model, 1.0, 0.0);
  Miss miss;
  for (const LaserScan& scan : measured) {
    const BeamTiming timing = calib::beam_timing(model, scan.ranges_m.size(), scan.bearing_step_rad);
    const double last_s = timing.of_beam_s(scan.ranges_m.size() - 1);
    const std::vector<PhaseKnot> knots =
        track.knots(scan.stamp_s, scan.stamp_s + timing.first_s, scan.stamp_s + last_s);
    EXPECT_GE(knots.size(), 2U);
    if (knots.size() < 2) return miss;
    for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
      const auto range_m = static_cast<double>(scan.ranges_m[k]);
      if (range_m >= scan.max_range_m) continue;
      const HitRow& hit = hits.at(miss.points++);
      const double elevation = table.elevation_rad(phase_at(knots, timing.of_beam_s(k)));
      const double bearing = scan.first_bearing_rad + static_cast<double>(k) * scan.bearing_step_rad;
      const Point3 point = embed(Pose2{0.5, 0.25, 0.0}) * T_base_laser(model.mount, scan.T_base_laser, elevation) *
                           Point3(range_m * std::cos(bearing), range_m * std::sin(bearing), 0.0);
      const double off_m = (point - Point3(hit.values[0], hit.values[1], hit.values[2])).norm();
      miss.most_m = std::max(miss.most_m, off_m);
      // One more turn of rounding for the poses' six decimals.
      miss.most_of_bound = std::max(miss.most_of_bound, off_m / (bound_at_1_m * (range_m + 0.1) + resolution_m + 2e-5));
    }
  }
  return miss;
}

TEST_F(SimulateNoddingTest, LogAndLinkageGiveTheTrueHits) {
  write("standing.yaml", kStanding);
  SimulateOptions chosen = options("a.log", "standing.yaml");
  chosen.truth_hits = true;
  const auto miss_of = [&](double resolution_m) {
    simulate(chosen);
    return reconstructed(messages("a.log"), scans("a.log"), read_linkage(path("a.linkage.yaml")),
                         read_hits(path("a.truth.ply")), resolution_m);
  };
  chosen.is_exact = true;
  const Miss exact = miss_of(0.0);
  EXPECT_GT(exact.points, 150'000U);
  EXPECT_LT(exact.most_m, 1e-3);
  // 20,000 ticks a turn and whole millimetres.
  chosen.is_exact = false;
  const Miss coarse = miss_of(0.001);
  EXPECT_LT(coarse.most_of_bound, 1.0);
  // More than the ranges' rounding alone: the ticks count.
  EXPECT_GT(coarse.most_m, 0.6e-3);
}

}  // namespace
}  // namespace gdtslam

#endif
