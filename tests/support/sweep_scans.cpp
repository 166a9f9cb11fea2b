#include "sweep_scans.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::test {
namespace {

/// `count` times from `first_s` to `last_s`, both included, uneven between.
std::vector<double> uneven_times(Random& random, double first_s, double last_s, std::size_t count) {
  std::vector<double> times{first_s, last_s};
  while (times.size() < count) times.push_back(random.uniform(first_s, last_s));
  std::sort(times.begin(), times.end());
  return times;
}

Pose2 draw_pose(Random& random, double most_m, double most_rad) {
  return {random.uniform(-most_m, most_m), random.uniform(-most_m, most_m), random.uniform(-most_rad, most_rad)};
}

}  // namespace

NoddingScanner draw_scanner(Random& random, std::uint32_t table_bits) {
  const double swing = random.uniform(0.2, 0.8);
  const double middle = random.uniform(-0.3, 0.8);
  std::vector<double> table((std::size_t{1} << table_bits) + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(table.size() - 1);
    table[i] = middle - swing * std::cos(kTwoPi * turn + 0.3 * std::sin(kTwoPi * turn));
  }
  const NoddingMount mount{.height_m = random.uniform(0.1, 1.5),
                           .lever_forward_m = random.uniform(-0.2, 0.2),
                           .lever_up_m = random.uniform(-0.2, 0.2),
                           .sensor_roll_rad = random.uniform(-0.1, 0.1),
                           .sensor_yaw_rad = random.uniform(-0.1, 0.1)};
  return {mount, ElevationTable(std::move(table)), random.uniform(10.0, 75.0), random.uniform()};
}

SweepScan draw_sweep_scan(Random& random, const NoddingScanner& scanner, std::uint32_t index, std::size_t beams) {
  SweepScan drawn;
  drawn.index = index;
  LaserScan& laser = drawn.scan.record.scan;
  laser.stamp_s = 1.0e9 + 0.05 * index;
  laser.bearing_step_rad = random.uniform(0.25, 1.0) * kPi / 180.0;
  laser.first_bearing_rad = -0.5 * laser.bearing_step_rad * static_cast<double>(beams);
  laser.max_range_m = 20.0;
  laser.T_base_laser = draw_pose(random, 0.4, 0.3);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    constexpr float kNone[] = {0.0F, -1.0F, 20.0F, 81.91F, std::numeric_limits<float>::quiet_NaN()};
    const bool is_none = random.below(10) == 0;
    laser.ranges_m.push_back(is_none ? kNone[random.below(5)] : static_cast<float>(random.uniform(0.2, 19.99)));
  }
  const BeamTiming timing = scanner.timing(beams, laser.bearing_step_rad);
  const double first_s = timing.of_beam_s(0);
  const double last_s = timing.of_beam_s(beams - 1);
  double turns = random.uniform();
  for (const double time_s : uneven_times(random, first_s, last_s, 2 + random.below(4))) {
    turns += random.uniform(-0.02, 0.04);
    drawn.scan.knots.push_back({time_s, phase_of_turns(turns)});
  }
  drawn.T_map_fix = draw_pose(random, 500.0, kPi);
  Pose2 pose = draw_pose(random, 2.0, kPi);
  for (const double time_s : uneven_times(random, first_s, last_s, 2 + random.below(3))) {
    drawn.poses.push_back({time_s, pose});
    pose = pose * draw_pose(random, 0.05, 0.1);
  }
  return drawn;
}

std::vector<SweepScan> draw_sweep_scans(Random& random, const NoddingScanner& scanner, std::size_t count) {
  std::vector<SweepScan> scans;
  for (std::uint32_t index = 0; index < count; ++index) {
    scans.push_back(draw_sweep_scan(random, scanner, index, 1 + random.below(400)));
  }
  return scans;
}

Cloud assemble(const NoddingScanner& scanner, const AssemblyLimits& limits, const std::vector<SweepScan>& scans,
               Backend& backend) {
  CloudKeeper keeper;
  SweepAssembler assembler(scanner, limits, backend, keeper);
  for (const SweepScan& scan : scans) assembler.add(scan.scan, scan.index, scan.T_map_fix, scan.poses);
  assembler.flush();
  return std::move(keeper.cloud);
}

}  // namespace gdtslam::test
