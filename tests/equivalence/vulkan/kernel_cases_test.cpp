// Every case of every kernel on the device: the CPU's bytes, guards and inputs untouched.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class KernelCasesOnDevice : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    GDTSLAM_NEEDS_VULKAN();
    device = test_backend();
  }
  void expect_equal(const KernelCaseSource& source) {
    const KernelCase kernel_case = source.make();
    const CaseOutcome expected = run_case(*cpu, kernel_case);
    const CaseOutcome found = run_case(*device, kernel_case);
    const auto apart = difference(kernel_case, expected, found);
    EXPECT_FALSE(apart) << source.name << ": " << apart->values << " values differ, by at most " << apart->largest
                        << ", the first in buffer " << apart->binding << " at (" << apart->x << ", " << apart->y << ")";
    EXPECT_TRUE(found.guards_intact) << source.name << ": something was written behind a buffer";
    EXPECT_TRUE(found.inputs_intact) << source.name << ": an input was written";
  }

  std::unique_ptr<Backend> cpu = make_cpu_backend({});
  std::unique_ptr<VulkanBackend> device;
};

TEST_P(KernelCasesOnDevice, GiveTheBytesOfTheCpu) {
  std::size_t tried = 0;
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.kernel->name != GetParam()) {
      continue;
    }
    ++tried;
    expect_equal(source);
    if (HasFailure()) {
      return;
    }
  }
  EXPECT_GT(tried, 0U);
  EXPECT_EQ(device->dispatch_count(), tried) << "dispatches that did not happen on " << device->device().name;
  EXPECT_GT(device->submit_count(), 0U);
  EXPECT_EQ(device->device().name, find_test_device().device->name);
}

std::vector<std::string> kernel_names() {
  std::vector<std::string> names;
  for (const KernelInfo* kernel : kernel_registry()) {
    names.emplace_back(kernel->name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, KernelCasesOnDevice, testing::ValuesIn(kernel_names()),
                         [](const auto& kernel) { return kernel.param; });

}  // namespace
}  // namespace gdtslam::test
