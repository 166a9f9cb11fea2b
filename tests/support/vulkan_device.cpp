#include "support/vulkan_device.hpp"

#include <algorithm>
#include <cstdlib>

namespace gdtslam::test {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

bool vulkan_is_required() { return variable("GDTSLAM_REQUIRE_VULKAN") == "1"; }

const TestDevice& find_test_device() {
  static const TestDevice found = [] {
    const VulkanListing listing = list_vulkan_devices();
    const std::string wanted = variable("GDTSLAM_TEST_VULKAN_DEVICE");
    const auto device = std::find_if(listing.devices.begin(), listing.devices.end(), [&](const auto& candidate) {
      return wanted.empty() ? candidate.kind == "lavapipe" : std::to_string(candidate.index) == wanted;
    });
    if (device == listing.devices.end()) {
      return TestDevice{std::nullopt, listing.problem.empty()
                                          ? "no lavapipe, or not the one asked for (" +
                                                std::to_string(listing.devices.size()) + " other devices)"
                                          : listing.problem};
    }
    return TestDevice{*device, ""};
  }();
  return found;
}

std::unique_ptr<VulkanBackend> test_backend(VulkanOptions options) {
  options.index = find_test_device().device.value().index;
  return make_vulkan_backend(options);
}

}  // namespace gdtslam::test
