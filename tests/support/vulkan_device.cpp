#include "vulkan_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// What came too late for an exception.
void report_late(std::string_view message) {
  if (testing::UnitTest::GetInstance()->current_test_info() != nullptr) {
    ADD_FAILURE() << "validation, at the end of a backend: " << message;
    return;
  }
  std::cerr << "validation, at the end of a backend that outlived its test: " << message << std::endl;
  std::abort();
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

const std::string& validation_problem() {
  static const std::string problem = [] {
    VulkanOptions options;
    options.validation = true;
    try {
      test_backend(options);
    } catch (const UnavailableError& error) {
      return std::string(error.what());
    }
    return std::string();
  }();
  return problem;
}

std::unique_ptr<VulkanBackend> test_backend(VulkanOptions options) {
  if (!options.on_message) {
    options.on_message = report_late;
  }
  options.index = find_test_device().device.value().index;
  options.spin_s = options.spin_s.value_or(0.0);  // the number of calls must not depend on the time
  return make_vulkan_backend(options);
}

}  // namespace gdtslam::test
