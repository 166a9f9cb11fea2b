// A drive mapped on the device: the bits of the CPU, as many submissions as the design promises, the host's copy of the
// map equal to the device's own, and a device that fails on the way.
#include <gtest/gtest.h>

#include <cstdlib>

#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class VulkanMapper : public testing::TestWithParam<MatcherKind> {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }

  MapperConfig config_ = quick_config(GetParam());
  std::vector<DriveScan> scans_ = room_scans(24, 4);
  std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
};

TEST_P(VulkanMapper, GivesTheBitsOfTheCpuAndItsCopyIsTheDevicesField) {
  config_.keyframe.every_scan = true;  // more than the journal holds, and growth on the way
  scans_ = room_scans(80, 2);
  const MappedDrive expected = map_drive(scans_, config_, *cpu_);
  const auto device = test_backend();
  expect_same(map_drive(scans_, config_, *device), expected);

  Mapper mapper(config_, *device);
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    mapper.process(scans_[i].scan, scans_[i].T_odom_base);
    if (i % 20 != 19) continue;
    const auto copy = mapper.field().cells();
    ASSERT_EQ(mapper.download_device_cells(), std::vector<std::uint16_t>(copy.begin(), copy.end())) << i;
  }
}

TEST(VulkanMapperSubmits, OnceForAWindowAndOnceForAKeyframe) {
  GDTSLAM_NEEDS_VULKAN();
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.keyframe.every_scan = true;  // so that the journal is cut short, which must cost no submission
  const std::vector<DriveScan> scans = room_scans(80, 2);
  const auto device = test_backend();
  Mapper mapper(config, *device);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::uint64_t before = device->submit_count();
    mapper.start(scans[i].scan, scans[i].T_odom_base);
    const std::uint64_t started = device->submit_count() - before;
    const MatchResult result = mapper.finish();
    EXPECT_EQ(started, result.attempts > 0 ? 1U : 0U) << i;
    EXPECT_EQ(device->submit_count() - before, result.attempts + (result.merged ? 1U : 0U)) << i;
  }
  const MapperStatistics& statistics = mapper.statistics();
  EXPECT_GT(statistics.keyframes, 64U);
  EXPECT_GE(statistics.attempts, statistics.matched - 1);
  EXPECT_EQ(statistics.submissions, statistics.attempts + statistics.keyframes);
  EXPECT_EQ(device->submit_count(), statistics.submissions);
}

// Every call takes minutes on a CPU as a device; a share of them, another one for each code, is tried unless
// GDTSLAM_EVERY_FAULT=1.
TEST_P(VulkanMapper, AnyCallOfADriveMayFail) {
  const MappedDrive expected = map_drive(scans_, config_, *cpu_);
  const auto whole = test_backend();
  expect_same(map_drive(scans_, config_, *whole), expected);
  const std::uint64_t calls = whole->call_count();
  ASSERT_GT(calls, 200U);
  const char* const every = std::getenv("GDTSLAM_EVERY_FAULT");
  const std::uint64_t step = every != nullptr && std::string(every) == "1" ? 1 : calls / 40;
  for (const auto code :
       {VulkanFault::Code::kDeviceLost, VulkanFault::Code::kOutOfDeviceMemory, VulkanFault::Code::kOutOfHostMemory}) {
    for (std::uint64_t at = 1 + static_cast<std::uint64_t>(code) * step / 3; at <= calls; at += step) {
      SCOPED_TRACE("call " + std::to_string(at) + " of " + std::to_string(calls));
      std::unique_ptr<VulkanBackend> device;
      try {
        device = test_backend({.fault = {at, code}});
      } catch (const DeviceError&) {
        continue;  // a device that cannot be had is not the mapper's concern
      }
      const MappedDrive found = map_drive(scans_, config_, *device);
      expect_same(found, expected);
      EXPECT_EQ(found.warnings.size(), 1U);
      EXPECT_NE(found.loss.find("vk"), std::string::npos) << found.loss;
      if (HasFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Matchers, VulkanMapper, testing::Values(MatcherKind::kSimplex, MatcherKind::kExhaustive),
                         [](const auto& kind) {
                           return kind.param == MatcherKind::kSimplex ? "simplex" : "exhaustive";
                         });

}  // namespace
}  // namespace gdtslam::test
