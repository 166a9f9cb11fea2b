// Scans of a nodding laser on their way to points of a cloud, as `map` makes them: beams are queued, the kernel
// sweep_points turns them into points, and these go to a sink. A robot that drives an arc while the crank turns.
#include <cmath>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/mapping/nodding/sweep_assembler.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kScans = 273;
constexpr std::size_t kBeams = 961;  // the paper's scanner: -30 to 210 degrees
constexpr double kScan_s = 1.0 / 37.5;
constexpr std::size_t kTableCells = std::size_t{1} << 15U;

/// Counts the points and keeps none.
class CountingSink : public CloudSink {
 public:
  void add(std::span<const CloudPoint> points) override { count += points.size(); }
  std::size_t count = 0;
};

NoddingScanner scanner() {
  std::vector<double> table(kTableCells + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = 0.78 - 0.78 * sin_cos(kTwoPi * static_cast<double>(i) / static_cast<double>(kTableCells)).cos;
  }
  return {{.height_m = 0.4, .lever_forward_m = 0.05, .lever_up_m = 0.02}, ElevationTable(std::move(table)), 37.5, 0.5};
}

NoddingScan scan_number(std::uint32_t number) {
  NoddingScan scan;
  LaserScan& laser = scan.record.scan;
  laser.stamp_s = number * kScan_s;
  laser.bearing_step_rad = rad_from_deg(0.25);
  laser.first_bearing_rad = rad_from_deg(-120.0);
  laser.T_base_laser = {0.2, 0.0, 0.0};
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    laser.ranges_m.push_back(1.0F + 0.01F * static_cast<float>((beam + 7 * number) % 900));
  }
  for (const double offset_s : {-0.5 * kScan_s, -0.2 * kScan_s, 0.3 * kScan_s, 0.5 * kScan_s}) {
    scan.knots.push_back({offset_s, phase_of_turns(0.1 * (laser.stamp_s + offset_s))});
  }
  return scan;
}

}  // namespace

std::vector<BenchRow> bench_sweeps(Backend& backend, const TimingOptions& options) {
  std::vector<NoddingScan> scans;
  for (std::uint32_t number = 0; number < kScans; ++number) scans.push_back(scan_number(number));
  const PoseKnot poses[] = {{-0.5 * kScan_s, {}}, {0.5 * kScan_s, {0.013, 0.0, 0.01}}};
  CountingSink sink;
  SweepAssembler assembler(scanner(), {}, backend, sink);
  const auto sweep = [&] {
    for (std::uint32_t number = 0; number < kScans; ++number) {
      assembler.add(scans[number], number, {3.0, -2.0, 0.01 * number}, poses);
    }
    assembler.flush();
  };
  sweep();
  if (sink.count != kScans * kBeams) throw Error(ExitCode::kFailed, "bench: beams of a sweep were lost");
  return {measured_row("sweep", "assemble_sweep",
                       std::to_string(kScans) + " scans of " + std::to_string(kBeams) + " beams", "beam",
                       static_cast<double>(kScans * kBeams), {.step = sweep}, options)};
}

}  // namespace gdtslam
