// Every call to the driver that a drive makes, from the opening of the device to the last scan, fails once: the mapper
// goes over to the CPU with one warning and the CPU's bits, and asks the device for nothing more; or, where it must not
// go over, fails with the name of the call and its code. GDTSLAM_FAULT_SHARE=N takes every N-th call only.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <tuple>

#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/room.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint64_t kShards = 8;
constexpr std::size_t kScans = 20;
constexpr int kBeams = 90;

std::uint64_t share() {
  const char* const text = std::getenv("GDTSLAM_FAULT_SHARE");
  const std::uint64_t every = text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
  if (every == 0 || every > 64) throw UsageError("GDTSLAM_FAULT_SHARE must be a number from 1 to 64");
  return every;
}

/// As cheap as a drive can be that has windows searched again, keyframes and a map that grows.
MapperConfig cheap_config() {
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.map.resolution_m = 0.06;
  config.merge.threshold_m = 0.06;
  config.search.max_points = 24;
  config.search.starts = 1;
  return config;
}

std::vector<DriveScan> cheap_scans() {
  const auto walls = furnished_room();
  const auto truth = drive_through_room();
  std::vector<DriveScan> scans;
  for (std::size_t i = 0; i < kScans; ++i) {
    const Pose2& pose = truth.at(i * 5);
    scans.push_back({scan_of(walls, pose, static_cast<double>(i), kBeams), pose});
  }
  return scans;
}

std::string code_name(VulkanFault::Code code) {
  return code == VulkanFault::Code::kDeviceLost ? "ErrorDeviceLost" : "ErrorOutOfDeviceMemory";
}

using Parameters = std::tuple<VulkanFault::Code, std::uint64_t>;

class MapperFaults : public testing::TestWithParam<Parameters> {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }

  /// The device with a fault, or nothing where it cannot even be opened.
  std::unique_ptr<VulkanBackend> open(std::uint64_t at) const {
    try {
      return test_backend({.fault = {at, code_}});
    } catch (const DeviceError& error) {
      EXPECT_THAT(error.call(), StartsWith("vk"));
      EXPECT_THAT(error.result(), StartsWith(code_name(code_)));
      return nullptr;
    }
  }

  void expect_recovery(std::uint64_t at, const MappedDrive& expected) const {
    const auto device = open(at);
    if (!device) return;
    std::uint64_t submissions = 0;  // until the loss was known
    const MappedDrive found = map_drive(scans_, config_, *device, [&] { submissions = device->submit_count(); });
    expect_same(found, expected);
    EXPECT_EQ(found.warnings.size(), 1U);
    EXPECT_THAT(found.loss, HasSubstr(" gave " + code_name(code_)));
    EXPECT_EQ(device->call_count(), at);
    EXPECT_EQ(device->submit_count(), submissions);
    loss_ = found.loss;
  }

  void expect_error(std::uint64_t at) const {
    const auto device = open(at);
    if (!device) return;
    try {
      Mapper mapper(config_, *device, {.fall_back = false, .cpu = {}, .warn = [](const auto&) { ADD_FAILURE(); }});
      for (const DriveScan& scan : scans_) mapper.process(scan.scan, scan.T_odom_base);
      ADD_FAILURE() << "no error";
    } catch (const DeviceError& error) {
      EXPECT_THAT(error.call(), StartsWith("vk"));
      EXPECT_THAT(error.result(), StartsWith(code_name(code_)));
      EXPECT_EQ(error.what(), loss_);  // the very call that the other run warned of
      EXPECT_THAT(error.what(), HasSubstr(error.call() + " gave " + code_name(code_)));
    }
    EXPECT_EQ(device->call_count(), at);
  }

  const VulkanFault::Code code_ = std::get<0>(GetParam());
  const std::uint64_t shard_ = std::get<1>(GetParam());
  const MapperConfig config_ = cheap_config();
  const std::vector<DriveScan> scans_ = cheap_scans();
  mutable std::string loss_;
};

TEST_P(MapperFaults, OfEveryCallOfADrive) {
  const auto cpu = make_cpu_backend({});
  const MappedDrive expected = map_drive(scans_, config_, *cpu);
  ASSERT_GT(expected.statistics.keyframes, 10U);
  ASSERT_GT(expected.statistics.attempts, expected.statistics.searches) << "no window was searched again";
  ASSERT_NE(map_drive({scans_.front()}, config_, *cpu).geometry, expected.geometry) << "the map never grew";
  const auto whole = test_backend();
  expect_same(map_drive(scans_, config_, *whole), expected);
  const std::uint64_t calls = whole->call_count();
  ASSERT_GT(calls, 200U);
  RecordProperty("calls", static_cast<int>(calls));
  for (std::uint64_t at = 1 + shard_ * share(); at <= calls; at += kShards * share()) {
    SCOPED_TRACE("call " + std::to_string(at) + " of " + std::to_string(calls));
    expect_recovery(at, expected);
    expect_error(at);
    if (HasFailure()) return;
  }
}

std::string name_of_shard(const testing::TestParamInfo<Parameters>& info) {
  const auto [code, shard] = info.param;
  return "exhaustive_" + code_name(code) + "_" + std::to_string(shard);
}

INSTANTIATE_TEST_SUITE_P(All, MapperFaults,
                         testing::Combine(testing::Values(VulkanFault::Code::kDeviceLost,
                                                          VulkanFault::Code::kOutOfDeviceMemory),
                                          testing::Range(std::uint64_t{0}, kShards)),
                         name_of_shard);

}  // namespace
}  // namespace gdtslam::test
