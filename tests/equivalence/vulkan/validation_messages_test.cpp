// Which messages of the validation layers and of the loader count, and what becomes of those that nobody takes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "engine/vulkan/device/instance.hpp"
#include "small_job.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::ElementsAre;

TEST(ValidationLog, KeepsWhatIsNotTakenAndHandsItOutInOrder) {
  std::vector<std::string> late;
  {
    ValidationLog log([&](std::string_view message) { late.emplace_back(message); });
    EXPECT_EQ(log.take(), "");
    log.add("a");
    log.add("b");
    EXPECT_EQ(log.take(), "a | b");
    EXPECT_EQ(log.take(), "");
    log.add("c");
    log.hand_out();
    EXPECT_THAT(late, ElementsAre("c"));
    log.add("d");
    log.add("e");
  }
  EXPECT_THAT(late, ElementsAre("c", "d", "e"));
}

using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;

TEST(ValidationFilter, CountsWhatValidationSaysFromWarningsOn) {
  for (const Type type : {Type::eValidation, Type::ePerformance}) {
    EXPECT_TRUE(counts_as_fault(Severity::eWarning, type, "VUID-x"));
    EXPECT_TRUE(counts_as_fault(Severity::eError, type, "VUID-x"));
    EXPECT_TRUE(counts_as_fault(Severity::eWarning, type | Type::eGeneral, ""));
    EXPECT_FALSE(counts_as_fault(Severity::eInfo, type, "VUID-x"));
    EXPECT_FALSE(counts_as_fault(Severity::eVerbose, type, "VUID-x"));
  }
}

TEST(ValidationFilter, CountsWhatIsGeneralFromErrorsOn) {
  EXPECT_TRUE(counts_as_fault(Severity::eError, Type::eGeneral, ""));
  EXPECT_FALSE(counts_as_fault(Severity::eWarning, Type::eGeneral, ""));
  EXPECT_FALSE(counts_as_fault(Severity::eInfo, Type::eGeneral, ""));
}

TEST(ValidationFilter, NeverCountsTheLoader) {
  EXPECT_FALSE(counts_as_fault(Severity::eWarning, Type::eGeneral, "Loader Message"));
  EXPECT_FALSE(counts_as_fault(Severity::eError, Type::eGeneral, "Loader Message"));
}

/// Sets a variable of the environment for its lifetime.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

/// The loader reports such a file as an error whenever an instance is made.
TEST(ValidationMessages, ABrokenFileOfAnotherDriverIsNoFaultOfOurs) {
  GDTSLAM_NEEDS_VULKAN();
  GDTSLAM_NEEDS_VALIDATION();
  const char* const chosen = std::getenv("VK_DRIVER_FILES");
  const std::string broken = "/nonexistent/driver.json";
  const Variable drivers = chosen == nullptr ? Variable("VK_ADD_DRIVER_FILES", broken)
                                             : Variable("VK_DRIVER_FILES", std::string(chosen) + ":" + broken);
  VulkanOptions options;
  options.validation = true;
  EXPECT_EQ(run_job(*test_backend(options), 2), run_job(*make_cpu_backend({}), 2));
}

}  // namespace
}  // namespace gdtslam::test
