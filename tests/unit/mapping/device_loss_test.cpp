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
  config_.local.stretch_m = 0.5;  // two maps at a time, of which the younger takes the place of the older on the way
  config_.odometry.estimate = true;
  config_.scan.max_range_m = 2.0;  // so little is seen at first that the map has to grow
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
    EXPECT_NE(mapper->device_loss(), "");
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
