// A quick verification runs every shader of the build: one that no case reaches could be wrong unseen.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "engine/compute/cases/kernel_cases.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam {
namespace {

TEST(ShaderCoverage, EveryShaderIsReachedByAQuickCase) {
  GDTSLAM_NEEDS_VULKAN();
  std::set<std::string> reached;
  VulkanOptions options;
  options.edit_shader = [&reached](std::string_view name, std::vector<std::uint32_t>&) { reached.emplace(name); };
  const std::unique_ptr<VulkanBackend> device = test::test_backend(options);
  for (const KernelCaseSource& source : kernel_cases()) {
    if (!source.large) run_case(*device, source.make());
  }
  for (const ShaderModule& shader : shader_modules()) {
    EXPECT_TRUE(reached.contains(std::string(shader.kernel))) << shader.kernel;
  }
}

}  // namespace
}  // namespace gdtslam
