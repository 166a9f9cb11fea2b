// The Vulkan device that tests run on: lavapipe, which is a package and is the same on every machine, or the device
// that GDTSLAM_TEST_VULKAN_DEVICE gives the number of.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam::test {

/// The device to test on, or why there is none.
struct TestDevice {
  std::optional<VulkanDeviceInfo> device;
  std::string problem;
};
const TestDevice& find_test_device();
/// Whether a missing device is a failure (GDTSLAM_REQUIRE_VULKAN=1).
bool vulkan_is_required();

/// Why the validation layer cannot be used on that device; empty where it can.
const std::string& validation_problem();

/// A backend on the device; the options' index is overwritten, and its waits sleep unless the options say otherwise.
/// What validation says at its end is a failure of the test that runs then, where the options have no listener of their
/// own; out of a test it ends the process.
std::unique_ptr<VulkanBackend> test_backend(VulkanOptions options = {});

}  // namespace gdtslam::test

/// At the start of a test: without a device the test fails where Vulkan is required, else it skips and says why.
#define GDTSLAM_NEEDS_VULKAN()                                                               \
  do {                                                                                       \
    const ::gdtslam::test::TestDevice& found_device = ::gdtslam::test::find_test_device();   \
    if (!found_device.device) {                                                              \
      if (::gdtslam::test::vulkan_is_required()) {                                           \
        FAIL() << "GDTSLAM_REQUIRE_VULKAN=1 and no Vulkan device: " << found_device.problem; \
      }                                                                                      \
      GTEST_SKIP() << "NOTHING WAS TESTED: no Vulkan device: " << found_device.problem;      \
    }                                                                                        \
    RecordProperty("vulkan_device", found_device.device->name);                              \
  } while (false)

/// The same for the validation layer: without it the test fails where Vulkan is required, else it skips and says why.
#define GDTSLAM_NEEDS_VALIDATION()                                           \
  do {                                                                       \
    const std::string& why_not = ::gdtslam::test::validation_problem();      \
    if (!why_not.empty()) {                                                  \
      if (::gdtslam::test::vulkan_is_required()) {                           \
        FAIL() << "GDTSLAM_REQUIRE_VULKAN=1 and no validation: " << why_not; \
      }                                                                      \
      GTEST_SKIP() << "NOTHING WAS TESTED: no validation: " << why_not;      \
    }                                                                        \
  } while (false)
