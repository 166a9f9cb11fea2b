// Every call to the driver that opening a device makes fails once: the command goes on with the CPU and one warning, or
// with --no-fallback fails with the name of the call and its code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "gdtslam/core/error.hpp"
#include "support/vulkan_device.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Code {
  const char* variable;  ///< as GDTSLAM_VULKAN_FAULT has it
  const char* result;
};

class OpeningFaults : public testing::TestWithParam<Code> {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
  void TearDown() override { unsetenv("GDTSLAM_VULKAN_FAULT"); }

  static DeviceOptions on_test_device(bool no_fallback) {
    return {.device = "vulkan:" + std::to_string(test::find_test_device().device.value().index),
            .no_fallback = no_fallback};
  }

  void set_fault(std::uint64_t at) const {
    setenv("GDTSLAM_VULKAN_FAULT", (std::to_string(at) + ":" + GetParam().variable).c_str(), 1);
  }
};

TEST_P(OpeningFaults, OfEveryCall) {
  const auto device = make_vulkan(on_test_device(true));
  ASSERT_NE(device, nullptr);
  const std::uint64_t calls = device->call_count();
  ASSERT_GT(calls, 5U);
  for (std::uint64_t at = 1; at <= calls; ++at) {
    SCOPED_TRACE("call " + std::to_string(at) + " of " + std::to_string(calls));
    set_fault(at);
    std::string text;
    try {
      make_backend(on_test_device(true));
      FAIL() << "no error";
    } catch (const DeviceError& error) {
      EXPECT_THAT(error.call(), StartsWith("vk"));
      EXPECT_EQ(error.result(), GetParam().result);
      text = error.what();
      EXPECT_THAT(text, HasSubstr(error.call() + " gave " + error.result()));
    }
    testing::internal::CaptureStderr();
    const auto backend = make_backend(on_test_device(false));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "gdtslam: warning: " + text + "; going on with the CPU\n");
    EXPECT_EQ(backend->device().kind, "cpu");
  }
  set_fault(calls + 1);
  EXPECT_NE(make_backend(on_test_device(false))->device().kind, "cpu");
}

INSTANTIATE_TEST_SUITE_P(All, OpeningFaults,
                         testing::Values(Code{"device-lost", "ErrorDeviceLost"},
                                         Code{"out-of-device-memory", "ErrorOutOfDeviceMemory"},
                                         Code{"out-of-host-memory", "ErrorOutOfHostMemory"}),
                         [](const auto& code) { return std::string(code.param.result); });

}  // namespace
}  // namespace gdtslam
