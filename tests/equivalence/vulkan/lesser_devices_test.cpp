// Devices that offer less than the one at hand, rehearsed by VulkanOptions::edit_device: other variants, the same
// bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/core/error.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class LesserDevices : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

/// Groups of 128 invocations are what every device runs: each kernel has a variant for them.
TEST_F(LesserDevices, SmallGroupsGiveTheSameBytes) {
  VulkanOptions options;
  options.edit_device = [](VulkanDeviceInfo& device) { device.max_group_invocations = 128; };
  const auto cpu = make_cpu_backend({});
  const auto device = test_backend(options);
  std::map<std::string_view, int> tried;
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.large || tried[source.kernel->name]++ > 20) continue;
    const KernelCase kernel_case = source.make();
    const CaseOutcome found = run_case(*device, kernel_case);
    ASSERT_FALSE(difference(kernel_case, run_case(*cpu, kernel_case), found)) << source.name;
    ASSERT_TRUE(found.guards_intact && found.inputs_intact) << source.name;
  }
  EXPECT_EQ(tried.size(), kernel_registry().size());
}

TEST_F(LesserDevices, ThatRunNoGroupOfAKernelAreRefused) {
  VulkanOptions options;
  options.edit_device = [](VulkanDeviceInfo& device) { device.max_group_invocations = 4; };
  const auto device = test_backend(options);
  try {
    const Buffer buffer = device->allocate(64 * 64 * 2);
    const Buffer points = device->allocate(8);
    const Buffer candidates = device->allocate(sizeof(PoseCandidate));
    const Buffer cost = device->allocate(4);
    run<PoseCost>(*device, {.width = 64, .height = 64, .stride = 64, .point_count = 1, .cap = 5120}, {1, 1, 1}, buffer,
                  points, candidates, cost);
    FAIL() << "a group of more invocations than the device runs";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.call(), "kernel pose_cost");
    EXPECT_THAT(error.result(), testing::HasSubstr("or 4 in all"));
  }
}

}  // namespace
}  // namespace gdtslam::test
