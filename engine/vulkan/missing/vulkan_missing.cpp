// Replaces the Vulkan part in builds without it (GDTSLAM_BUILD_VULKAN=OFF); its header needs no Vulkan.
#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {
namespace {

constexpr const char* kMissing =
    "this build has no Vulkan backend (configure it with -DGDTSLAM_BUILD_VULKAN=ON); use --device cpu, which gives the "
    "same results";

}  // namespace

VulkanListing list_vulkan_devices() { return {{}, kMissing}; }

std::unique_ptr<VulkanBackend> make_vulkan_backend(const VulkanOptions& /*options*/) {
  throw UnavailableError(kMissing);
}

std::span<const ShaderModule> shader_modules() { return {}; }

}  // namespace gdtslam
