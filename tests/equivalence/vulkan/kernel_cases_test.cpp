// Every case of every kernel on the device: the CPU's bytes, guards and inputs untouched, whichever forms are taken.
#include <gtest/gtest.h>

#include <memory>
#include <tuple>

#include "gdtslam/compute/kernel_cases.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

const char* name_of(ShaderForms forms) {
  switch (forms) {
    case ShaderForms::kByDevice:
      return "by_device";
    case ShaderForms::kWide:
      return "wide";
    case ShaderForms::kNoTexels:
      return "no_texels";
    case ShaderForms::kNarrow:
      break;
  }
  return "narrow";
}

class KernelCasesOnDevice : public testing::TestWithParam<std::tuple<std::string, ShaderForms>> {
 protected:
  void SetUp() override {
    GDTSLAM_NEEDS_VULKAN();
    VulkanOptions options;
    options.forms = std::get<1>(GetParam());
    device = test_backend(options);
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
    if (source.kernel->name != std::get<0>(GetParam())) {
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

/// The kernels with forms that read texels, whose other forms would else not be taken on a device that has them.
std::vector<std::string> texel_kernel_names() {
  std::vector<std::string> names;
  for (const ShaderModule& shader : shader_modules()) {
    if (shader.texel_binding >= 0 && (names.empty() || names.back() != shader.kernel)) {
      names.emplace_back(shader.kernel);
    }
  }
  return names;
}

std::string case_name(const testing::TestParamInfo<std::tuple<std::string, ShaderForms>>& param) {
  return std::get<0>(param.param) + "_" + name_of(std::get<1>(param.param));
}

INSTANTIATE_TEST_SUITE_P(All, KernelCasesOnDevice,
                         testing::Combine(testing::ValuesIn(kernel_names()),
                                          testing::Values(ShaderForms::kByDevice, ShaderForms::kWide,
                                                          ShaderForms::kNarrow)),
                         case_name);
INSTANTIATE_TEST_SUITE_P(WithoutTexels, KernelCasesOnDevice,
                         testing::Combine(testing::ValuesIn(texel_kernel_names()),
                                          testing::Values(ShaderForms::kNoTexels)),
                         case_name);

}  // namespace
}  // namespace gdtslam::test
