// What the assembler makes of scans beside the geometry (tests/oracle/mapping): which beams become points, in which
// order and with what labels; that batches and devices change nothing; that a device that fails loses nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "support/queued_backend.hpp"
#include "support/sweep_scans.hpp"

namespace gdtslam {
namespace {

using test::assemble;
using test::draw_sweep_scan;
using test::draw_sweep_scans;
using test::QueuedBackend;
using test::SweepScan;

/// A laser half a metre up whose elevation is measured itself, all beams at once.
NoddingScanner level_scanner() { return {{.height_m = 0.5}, ElevationTable::identity(), 0.0, 0.5}; }

/// Beams ahead, to the left, behind and to the right, at an elevation.
SweepScan four_beams(double elevation_rad, std::vector<float> ranges_m = {1.0F, 2.0F, 3.0F, 4.0F}) {
  SweepScan scan;
  LaserScan& laser = scan.scan.record.scan;
  laser.stamp_s = 100.0;
  laser.bearing_step_rad = kPi / 2.0;
  laser.ranges_m = std::move(ranges_m);
  scan.scan.knots = {{0.0, phase_of_elevation(elevation_rad)}};
  scan.poses = {{0.0, {}}};
  return scan;
}

constexpr double kClose_m = 1.2e-5;  // the sagitta that a strip may cut off, and float32

void expect_at(const CloudPoint& point, double x_m, double y_m, double z_m) {
  EXPECT_NEAR(static_cast<double>(point.x_m), x_m, kClose_m);
  EXPECT_NEAR(static_cast<double>(point.y_m), y_m, kClose_m);
  EXPECT_NEAR(static_cast<double>(point.z_m), z_m, kClose_m);
}

class SweepAssembly : public testing::Test {
 protected:
  Cloud to_points(const std::vector<SweepScan>& scans) { return assemble(scanner, limits, scans, *cpu); }

  NoddingScanner scanner = level_scanner();
  AssemblyLimits limits;
  std::unique_ptr<Backend> cpu = make_cpu_backend({});
};

TEST_F(SweepAssembly, LiftsTheForwardBeamAndLeavesTheAxisWhereItIs) {
  const Cloud cloud = to_points({four_beams(rad_from_deg(30.0))});
  ASSERT_EQ(cloud.size(), 4U);
  expect_at(cloud[0], std::sqrt(0.75), 0.0, 0.5 + 0.5);
  expect_at(cloud[1], 0.0, 2.0, 0.5);
  expect_at(cloud[2], -3.0 * std::sqrt(0.75), 0.0, 0.5 - 1.5);
  expect_at(cloud[3], 0.0, -4.0, 0.5);
  EXPECT_NEAR(static_cast<double>(cloud[2].elevation_rad), rad_from_deg(30.0), 1.0e-6);
}

// (14) as printed scales the translation by the height over the sensor: it is off by exactly (x, y)(P_Z - 1), and at
// elevation 0 nothing of the translation is left.
TEST_F(SweepAssembly, LiteralFormScalesTheTranslationByTheHeight) {
  SweepScan scan = four_beams(rad_from_deg(30.0));
  scan.poses = {{0.0, {2.0, -3.0, kPi / 2.0}}};
  SweepScan level = scan;
  level.scan.knots = {{0.0, phase_of_elevation(0.0)}};
  const Cloud working = to_points({scan, level});
  limits.form = SweepForm::kLiteral;
  const Cloud literal = to_points({scan, level});
  const double above_sensor[] = {0.5, 0.0, -1.5, 0.0, 0.0, 0.0, 0.0, 0.0};
  ASSERT_EQ(working.size(), 8U);
  ASSERT_EQ(literal.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    const double error = above_sensor[i] - 1.0;
    expect_at(literal[i], static_cast<double>(working[i].x_m) + 2.0 * error,
              static_cast<double>(working[i].y_m) - 3.0 * error, static_cast<double>(working[i].z_m));
  }
  expect_at(working[4], 2.0, -2.0, 0.5);
  expect_at(literal[4], 0.0, 1.0, 0.5);
}

TEST_F(SweepAssembly, LeavesOutWhatIsNoReturn) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  limits.min_range_m = 0.5;
  limits.max_range_m = 10.0;
  SweepScan scan = four_beams(0.0, {0.0F, -1.0F, kNaN, kInfinity, 0.49F, 0.5F, 7.99F, 8.0F, 9.99F, 10.0F, -kInfinity});
  EXPECT_EQ(to_points({scan}).size(), 4U);  // 0.5, 7.99, 8, 9.99
  scan.scan.record.scan.max_range_m = 8.0;
  EXPECT_EQ(to_points({scan}).size(), 2U);  // 0.5, 7.99
  limits.min_range_m = 0.0;
  EXPECT_EQ(to_points({scan}).size(), 3U);  // a range of 0 is none
}

TEST_F(SweepAssembly, ScansWithoutElevationOrPlaceGiveNoPoints) {
  SweepScan unknown = four_beams(0.1);
  unknown.scan.knots.clear();
  SweepScan empty = four_beams(0.1, {});
  SweepScan nowhere = four_beams(0.1);
  nowhere.scan.record.scan.T_base_laser.x_m = std::numeric_limits<double>::quiet_NaN();
  SweepScan far = four_beams(0.1);
  far.scan.record.scan.T_base_laser.y_m = -1.0e5;
  EXPECT_TRUE(to_points({unknown, empty, nowhere, far}).empty());
  EXPECT_EQ(to_points({unknown, four_beams(0.1), empty}).size(), 4U);
}

TEST_F(SweepAssembly, PointsKeepOrderStampAndScan) {
  scanner.mirror_rate_hz = 10.0;  // a quarter turn takes 25 ms
  scanner.stamp_share = 1.0;
  SweepScan first = four_beams(0.2);
  first.index = 7;
  first.scan.record.scan.ranges_m[1] = 0.0F;
  SweepScan second = four_beams(0.3);
  second.index = 5;
  second.scan.record.scan.stamp_s = 50.0;
  const Cloud cloud = to_points({first, second});
  ASSERT_EQ(cloud.size(), 7U);
  const double stamps[] = {99.925, 99.975, 100.0, 49.925, 49.95, 49.975, 50.0};
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(cloud[i].stamp_s, stamps[i], 1.0e-9);
    EXPECT_EQ(cloud[i].scan, i < 3 ? 7U : 5U);
  }
}

// Half a turn each way is ambiguous; less is the short way, through phase 0 as well.
TEST_F(SweepAssembly, PhaseWrapsTheShortWay) {
  std::vector<double> table(65);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = 0.01 * static_cast<double>(std::min(i, 64 - i));
  scanner.table = ElevationTable(table);
  scanner.mirror_rate_hz = 10.0;
  SweepScan scan = four_beams(0.0);
  scan.scan.knots = {{-0.0375, phase_of_turns(-3.0 / 64.0)}, {0.0375, phase_of_turns(3.0 / 64.0)}};
  const Cloud cloud = to_points({scan});
  ASSERT_EQ(cloud.size(), 4U);
  const double elevations[] = {0.03, 0.01, 0.01, 0.03};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(static_cast<double>(cloud[i].elevation_rad), elevations[i], 1.0e-7);
  }
}

TEST_F(SweepAssembly, FarFromTheOriginCostsNoMoreThanTheRoundingOfThePoint) {
  SweepScan scan = four_beams(0.0);
  scan.T_map_fix = {4096.4, -8191.7, 0.0};
  for (const CloudPoint& point : to_points({scan})) {
    EXPECT_LE(std::fabs(static_cast<double>(point.x_m) - 4096.4), 3.0 + 0.00025);
  }
  EXPECT_EQ(to_points({scan})[0].x_m, static_cast<float>(4096.4 + 1.0));
  EXPECT_EQ(to_points({scan})[1].y_m, static_cast<float>(-8191.7 + 2.0));
}

class SweepBatches : public testing::Test {
 protected:
  static std::vector<SweepScan> draw(const NoddingScanner& scanner) {
    Random random(5);
    std::vector<SweepScan> scans = draw_sweep_scans(random, scanner, 40);
    scans.push_back(draw_sweep_scan(random, scanner, 40, 9000));  // more than a batch
    for (std::uint32_t index = 41; index < 60; ++index) scans.push_back(draw_sweep_scan(random, scanner, index, 361));
    return scans;
  }

  NoddingScanner scanner = [] {
    Random random(4);
    return test::draw_scanner(random);
  }();
  std::vector<SweepScan> scans = draw(scanner);
  std::unique_ptr<Backend> cpu = make_cpu_backend({});
  Cloud expected = assemble(scanner, {}, scans, *cpu);
};

TEST_F(SweepBatches, ChangeNothing) {
  ASSERT_GT(expected.size(), 15000U);
  for (const std::uint32_t batch_beams : {0U, 1024U, 1025U, 1777U, 4096U, 1U << 20U}) {
    EXPECT_TRUE(assemble(scanner, {.batch_beams = batch_beams}, scans, *cpu) == expected) << batch_beams;
  }
}

TEST_F(SweepBatches, FlushingAfterEachScanChangesNothing) {
  CloudKeeper keeper;
  SweepAssembler assembler(scanner, {}, *cpu, keeper);
  for (const SweepScan& scan : scans) {
    assembler.add(scan.scan, scan.index, scan.T_map_fix, scan.poses);
    assembler.flush();
    EXPECT_EQ(assembler.points(), keeper.cloud.size());
  }
  EXPECT_TRUE(keeper.cloud == expected);
}

// More ways to lay out bearings than the table of directions takes.
TEST_F(SweepBatches, ManyLayoutsOfBearings) {
  Random random(6);
  std::vector<SweepScan> many;
  for (std::uint32_t index = 0; index < 40; ++index) many.push_back(draw_sweep_scan(random, scanner, index, 20000));
  const Cloud together = assemble(scanner, {}, many, *cpu);
  Cloud alone;
  for (const SweepScan& scan : many) {
    const Cloud points = assemble(scanner, {}, {scan}, *cpu);
    alone.insert(alone.end(), points.begin(), points.end());
  }
  EXPECT_TRUE(together == alone);
}

// The device has the next batch before the host waits for the one before it.
TEST_F(SweepBatches, DownloadsOverlapWithTheNextBatch) {
  QueuedBackend device;
  EXPECT_TRUE(assemble(scanner, {.batch_beams = 4096}, scans, device) == expected);
  std::vector<std::string> order;
  for (const std::string& call : device.calls()) {
    if (call == "sweep_points" || call == "finish_download") order.push_back(call);
  }
  ASSERT_GT(order.size(), 6U);
  EXPECT_EQ(order[0], "sweep_points");
  for (std::size_t i = 1; i + 1 < order.size(); ++i) {
    EXPECT_EQ(order[i], i % 2 == 1 ? "sweep_points" : "finish_download") << i;
  }
  EXPECT_EQ(device.submit_count(), order.size() / 2);
}

// While the robot turns, the sensor ahead of it goes on an arc, which strips cut into chords.
TEST_F(SweepAssembly, TurningRobotCutsStripsFineEnough) {
  scanner.mirror_rate_hz = 5.0;
  SweepScan scan = four_beams(0.0, std::vector<float>(361, 1.0F));
  LaserScan& laser = scan.scan.record.scan;
  laser.bearing_step_rad = kPi / 360.0;
  laser.T_base_laser = {0.5, 0.0, 0.0};
  laser.first_bearing_rad = 0.0;
  scan.poses = {{-0.05, {}}, {0.05, {0.0, 0.0, 1.0}}};
  const Cloud cloud = to_points({scan});
  ASSERT_EQ(cloud.size(), 361U);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double share = static_cast<double>(i) / 360.0;
    const double bearing = share + kPi * share;
    expect_at(cloud[i], 0.5 * std::cos(share) + std::cos(bearing), 0.5 * std::sin(share) + std::sin(bearing), 0.5);
  }
}

}  // namespace
}  // namespace gdtslam
