// A device that fails at the k-th call, for every k of a drive: the poses and the map are those of the CPU, one warning
// is given, and the device is asked for nothing more. The drive on the CPU is the reference.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/queued_backend.hpp"

namespace gdtslam {
namespace {

using test::DriveScan;
using test::map_drive;
using test::MappedDrive;
using test::QueuedBackend;

class DeviceLoss : public testing::Test {
 protected:
  [[nodiscard]] MappedDrive drive(Backend& backend) const { return map_drive(scans_, config_, backend); }

  void expect_recovery_from(std::uint64_t call, const MappedDrive& expected) const {
    QueuedBackend device(call);
    const MappedDrive found = drive(device);
    expect_same(found, expected);
    EXPECT_EQ(found.warnings.size(), 1U);
    EXPECT_EQ(device.calls().size(), call);
    EXPECT_EQ(device.calls_after_failure(), 0U);
    EXPECT_EQ(found.loss, "queued: " + device.calls().back() + " gave ErrorDeviceLost");
    EXPECT_TRUE(!found.warnings.empty() && found.warnings[0].starts_with(found.loss));
    // Of both: the whole drive, but for a field that need not grow a second time, and some of what the device had done
    // once more.
    EXPECT_GE(found.statistics.dispatches + 1, expected.statistics.dispatches);
    EXPECT_LE(found.statistics.dispatches, expected.statistics.dispatches + device.dispatch_count());
  }

  MapperConfig config_ = test::quick_config(MatcherKind::kExhaustive);
  std::vector<DriveScan> scans_ = test::room_scans(24, 4);
  std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
};

TEST_F(DeviceLoss, EveryCallOfADriveMayFail) {
  const MappedDrive expected = drive(*cpu_);
  QueuedBackend device;
  const MappedDrive whole = drive(device);
  expect_same(whole, expected);
  EXPECT_EQ(whole.loss, "");
  const auto& calls = device.calls();
  ASSERT_GT(std::count(calls.begin(), calls.end(), "gdt_stamp"), 10) << "too few keyframes for a test";
  ASSERT_GT(std::count(calls.begin(), calls.end(), "field_grow"), 0) << "the map never grew";
  for (std::uint64_t call = 1; call <= calls.size(); ++call) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + calls[call - 1]);
    expect_recovery_from(call, expected);
    if (HasFailure()) return;
  }
}

// Two maps at a time, of which the younger takes the place of the older on the way.
TEST_F(DeviceLoss, WithLocalMaps) {
  config_.local.stretch_m = 0.5;
  config_.odometry.estimate = true;
  const MappedDrive expected = drive(*cpu_);
  QueuedBackend device;
  expect_same(drive(device), expected);
  for (std::uint64_t call = 1; call <= device.calls().size(); call += 3) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + device.calls()[call - 1]);
    expect_recovery_from(call, expected);
    if (HasFailure()) return;
  }
}

TEST_F(DeviceLoss, WhileTheJournalIsBeingCutShort) {
  config_.keyframe.every_scan = true;
  scans_ = test::room_scans(160, 1);
  const MappedDrive expected = drive(*cpu_);
  QueuedBackend device;
  expect_same(drive(device), expected);
  // A checkpoint begins with a copy of the field.
  const auto& calls = device.calls();
  std::vector<std::uint64_t> checkpoints;
  for (std::size_t i = 1; i < calls.size(); ++i) {
    if (calls[i] == "start_download" && calls[i - 1] == "field_grow") checkpoints.push_back(i + 1);
  }
  ASSERT_EQ(checkpoints.size(), 2U);
  for (const std::uint64_t checkpoint : checkpoints) {
    for (std::uint64_t call = checkpoint - 3; call < checkpoint + 25; ++call) {
      SCOPED_TRACE("call " + std::to_string(call) + ", " + calls[call - 1]);
      expect_recovery_from(call, expected);
      if (HasFailure()) return;
    }
  }
}

TEST_F(DeviceLoss, WithoutLeaveToFallBackTheErrorComesAndTheMapIsWhole) {
  // The map after each keyframe, from the CPU.
  Mapper reference(config_, *cpu_);
  std::vector<std::vector<std::uint16_t>> maps{{}};
  for (const DriveScan& s : scans_) {
    if (reference.process(s.scan, s.T_odom_base).merged) maps.push_back(reference.field().download());
  }
  QueuedBackend whole;
  expect_same(drive(whole), drive(*cpu_));
  std::size_t failures_after_construction = 0;
  for (std::uint64_t call = 1; call <= whole.calls().size(); call += 3) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + whole.calls()[call - 1]);
    QueuedBackend device(call);
    std::unique_ptr<Mapper> mapper;
    try {
      mapper = std::make_unique<Mapper>(config_, device, MapperOptions{.fall_back = false, .cpu = {}, .warn = {}});
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.result(), "ErrorDeviceLost");
      continue;
    }
    ++failures_after_construction;
    const auto map_all = [&] {
      for (const DriveScan& s : scans_) mapper->process(s.scan, s.T_odom_base);
    };
    EXPECT_THROW(map_all(), DeviceError);
    EXPECT_TRUE(mapper->lost_device());
    EXPECT_THROW(map_all(), DeviceError) << "a second time";
    EXPECT_EQ(device.calls_after_failure(), 0U);
    EXPECT_TRUE(mapper->field().download() == maps.at(mapper->statistics().keyframes));
    if (HasFailure()) return;
  }
  EXPECT_GT(failures_after_construction, 50U);
}

TEST_F(DeviceLoss, AMapBeyondTheLargestBufferGoesOnOnTheCpu) {
  const MappedDrive expected = drive(*cpu_);
  QueuedBackend device;
  // The rows of the map need some more than this.
  device.set_max_buffer_bytes(std::size_t{2} * static_cast<std::size_t>(expected.geometry.width) *
                              static_cast<std::size_t>(expected.geometry.height));
  const MappedDrive found = drive(device);
  expect_same(found, expected);
  EXPECT_NE(found.loss.find("too large"), std::string::npos) << found.loss;
}

/// Scans of one room that the robot sees again and again, farther off each time: none matches, all are merged.
struct LongDrive {
  explicit LongDrive(Backend& backend)
      : mapper(config_of(), backend, {.cpu = {}, .warn = {}, .scratch_folder = testing::TempDir()}) {}
  static MapperConfig config_of() {
    MapperConfig config = test::quick_config(MatcherKind::kExhaustive);
    config.odometry.max_step_m = 100.0;
    return config;
  }
  void go_on(int scans) {
    const DriveScan first = test::room_scans(1, 1).front();
    for (int k = 0; k < scans; ++k) {
      const auto step = static_cast<double>(poses.size());
      poses.push_back(mapper.process(first.scan, Pose2{40.0 * step, 40.0 * step, 0.0}).T_map_base);
    }
  }
  [[nodiscard]] std::vector<std::uint16_t> cells_around(const Pose2& pose) const {
    constexpr std::int32_t kHalf = 130;
    const CellIndex at = map_cell_of(pose.translation(), mapper.config().map.resolution_m);
    std::vector<std::uint16_t> cells;
    std::vector<std::uint16_t> row(2 * kHalf);
    for (std::int32_t y = -kHalf; y < kHalf; ++y) {
      mapper.field().read_row(at + CellOffset{-kHalf, y}, row);
      cells.insert(cells.end(), row.begin(), row.end());
    }
    return cells;
  }
  Mapper mapper;
  std::vector<Pose2> poses;
};

// Beyond the 2^32 cells of a map that has to be in memory: what is far from the robot waits on disk, as it does on the
// CPU from the start.
TEST(DeviceLossOnALongDrive, TheMapGrowsAsThatOfTheCpu) {
  constexpr int kScans = 56;  // 2.2 km along x and y
  const auto cpu = make_cpu_backend({});
  LongDrive expected(*cpu);
  expected.go_on(kScans);
  ASSERT_EQ(expected.mapper.statistics().keyframes, std::uint64_t{kScans});
  QueuedBackend whole;
  LongDrive(whole).go_on(3);
  QueuedBackend device(whole.calls().size());
  LongDrive found(device);
  found.go_on(kScans);
  ASSERT_TRUE(found.mapper.lost_device());
  EXPECT_TRUE(found.poses == expected.poses);
  EXPECT_EQ(found.mapper.statistics().keyframes, expected.mapper.statistics().keyframes);
  const CellBox& box = expected.mapper.field().box();
  EXPECT_GT(std::int64_t{box.width()} * box.height(), std::int64_t{1} << 32U);
  EXPECT_EQ(found.mapper.field().box(), box);
  for (const Pose2& pose : expected.poses) {
    ASSERT_TRUE(found.cells_around(pose) == expected.cells_around(pose)) << pose.x_m;
  }
}

// A matcher that walks on the host has its map there, so whatever happens to the device is no loss.
TEST(DeviceOfAHostMatcher, IsAskedForNothing) {
  const MapperConfig config = test::quick_config(MatcherKind::kSimplex);
  const std::vector<DriveScan> scans = test::room_scans(24, 4);
  const auto cpu = make_cpu_backend({});
  QueuedBackend device(1);
  const MappedDrive found = map_drive(scans, config, device);
  expect_same(found, map_drive(scans, config, *cpu));
  EXPECT_EQ(found.loss, "");
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_TRUE(device.calls().empty());
}

}  // namespace
}  // namespace gdtslam
