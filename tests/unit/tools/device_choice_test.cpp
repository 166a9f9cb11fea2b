// Which device a name stands for, and the folder of the caches.
#include "tools/gdtslam/shell/device/device_option.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

VulkanDeviceInfo device(unsigned index, const std::string& name, const std::string& kind,
                        const std::string& problem = "") {
  VulkanDeviceInfo info;
  info.index = index;
  info.name = name;
  info.kind = kind;
  info.driver = "driver 1";
  info.problem = problem;
  return info;
}

const VulkanListing kMixed{{device(0, "llvmpipe", "lavapipe"), device(1, "Old GPU", "discrete", "has Vulkan 1.0"),
                            device(2, "GPU", "integrated"), device(3, "Big GPU", "discrete")},
                           ""};
const VulkanListing kSoftware{{device(0, "llvmpipe", "lavapipe")}, ""};
const VulkanListing kNone{{}, "there is no driver"};

std::optional<unsigned> chosen(const std::string& name, const VulkanListing& listing) {
  return choose_device(parse_device_name(name), listing);
}

std::string refusal(const std::string& name, const VulkanListing& listing) {
  try {
    chosen(name, listing);
  } catch (const UnavailableError& error) {
    EXPECT_EQ(error.code(), ExitCode::kUnavailable);
    return error.what();
  }
  return "";
}

TEST(DeviceName, IsOneOfFourForms) {
  EXPECT_EQ(parse_device_name("auto").kind, DeviceName::Kind::kAuto);
  EXPECT_EQ(parse_device_name("cpu").kind, DeviceName::Kind::kCpu);
  EXPECT_EQ(parse_device_name("vulkan").kind, DeviceName::Kind::kVulkan);
  EXPECT_EQ(parse_device_name("vulkan").index, std::nullopt);
  EXPECT_EQ(parse_device_name("vulkan:0").index, 0U);
  EXPECT_EQ(parse_device_name("vulkan:9999").index, 9999U);
}

TEST(DeviceName, OthersAreRefused) {
  for (const char* name : {"", "gpu", "vulkan:", "vulkan:-1", "vulkan:x", "vulkan:1x", "vulkan:12345", "vulkan0", "CPU",
                           "vulkan: 1", "cpu:0"}) {
    EXPECT_THROW(parse_device_name(name), UsageError) << name;
  }
}

TEST(DeviceChoice, AutoTakesTheFirstHardwareGpuThatWorks) {
  EXPECT_EQ(chosen("auto", kMixed), 2U);
  EXPECT_EQ(chosen("auto", kSoftware), std::nullopt) << "lavapipe only when it is named";
  EXPECT_EQ(chosen("auto", kNone), std::nullopt);
}

TEST(DeviceChoice, VulkanTakesHardwareFirstAndElseWhatThereIs) {
  EXPECT_EQ(chosen("vulkan", kMixed), 2U);
  EXPECT_EQ(chosen("vulkan", kSoftware), 0U);
  EXPECT_EQ(chosen("vulkan:0", kMixed), 0U);
  EXPECT_EQ(chosen("vulkan:3", kMixed), 3U);
  EXPECT_EQ(chosen("cpu", kMixed), std::nullopt);
}

TEST(DeviceChoice, SaysWhyANamedDeviceCannotBeHad) {
  EXPECT_EQ(refusal("vulkan", kNone), "--device vulkan: there is no driver");
  EXPECT_THAT(refusal("vulkan:1", kMixed), HasSubstr("--device vulkan:1: Old GPU cannot be used: has Vulkan 1.0"));
  EXPECT_THAT(refusal("vulkan:7", kSoftware), HasSubstr("there is no such device, only vulkan:0 (llvmpipe)"));
  const VulkanListing broken{{device(0, "Old GPU", "discrete", "has Vulkan 1.0")}, ""};
  EXPECT_THAT(refusal("vulkan", broken), HasSubstr("no device can be used: vulkan:0 (Old GPU: has Vulkan 1.0)"));
}

/// A folder of its own, and the environment as it was afterwards.
class CacheTest : public testing::Test {
 public:
  CacheTest() {
    std::string name = (fs::temp_directory_path() / "gdtslam-cache-XXXXXX").string();
    work_ = ::mkdtemp(name.data());
    for (const char* variable : {"XDG_CACHE_HOME", "HOME"}) {
      const char* const value = std::getenv(variable);
      saved_.emplace_back(variable, value == nullptr ? std::optional<std::string>() : value);
    }
  }
  ~CacheTest() override {
    for (const auto& [variable, value] : saved_) set(variable.c_str(), value);
    fs::remove_all(work_);
  }

 protected:
  static void set(const char* variable, const std::optional<std::string>& value) {
    if (value) {
      ::setenv(variable, value->c_str(), 1);
    } else {
      ::unsetenv(variable);
    }
  }

  fs::path work_;

 private:
  std::vector<std::pair<std::string, std::optional<std::string>>> saved_;
};

TEST_F(CacheTest, IsMadeForThisUserAlone) {
  set("XDG_CACHE_HOME", (work_ / "a" / "b").string());
  EXPECT_EQ(cache_folder().path, (work_ / "a" / "b" / "gdtslam").string());
  struct stat status {};
  ASSERT_EQ(::stat((work_ / "a" / "b" / "gdtslam").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
  EXPECT_EQ(cache_folder().path, (work_ / "a" / "b" / "gdtslam").string()) << "the second time";
}

TEST_F(CacheTest, IsMissingWhereItCannotBe) {
  set("XDG_CACHE_HOME", std::nullopt);
  set("HOME", std::nullopt);
  EXPECT_EQ(cache_folder().path, "");
  EXPECT_THAT(cache_folder().problem, HasSubstr("HOME names no folder"));
  set("HOME", (work_ / "nobody").string());
  EXPECT_EQ(cache_folder().path, "");
  EXPECT_THAT(cache_folder().problem, HasSubstr("HOME names no folder"));
  EXPECT_FALSE(fs::exists(work_ / "nobody")) << "a home was made";
  std::ofstream(work_ / "file") << "no folder";
  set("XDG_CACHE_HOME", (work_ / "file").string());
  EXPECT_EQ(cache_folder().path, "");
  EXPECT_THAT(cache_folder().problem, HasSubstr("cannot be made: Not a directory"));
}

}  // namespace
}  // namespace gdtslam
