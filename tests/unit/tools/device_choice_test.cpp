// Which device a name stands for, the folder of the caches and the results of earlier verifications.
#include "tools/gdtslam/shell/device/device_option.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/device/verify_record.hpp"
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

bool trust_all(const VulkanDeviceInfo& /*device*/) { return false; }

std::optional<unsigned> chosen(const std::string& name, const VulkanListing& listing) {
  return choose_device(parse_device_name(name), listing, trust_all).index;
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

TEST(DeviceName, AGpuIsVulkanAndNotTheNearestByItsLetters) {
  for (const char* name : {"gpu", "GPU", "gpu:0"}) {
    try {
      parse_device_name(name);
      ADD_FAILURE() << name;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("did you mean 'vulkan'?")) << name;
    }
  }
}

TEST(DeviceChoice, AutoTakesTheFirstHardwareGpuThatWorks) {
  EXPECT_EQ(chosen("auto", kMixed), 2U);
  EXPECT_EQ(chosen("auto", kSoftware), std::nullopt) << "lavapipe only when it is named";
  EXPECT_EQ(chosen("auto", kNone), std::nullopt);
}

TEST(DeviceChoice, AutoLeavesOutADeviceThatFailedVerification) {
  const DeviceChoice other =
      choose_device({}, kMixed, [](const VulkanDeviceInfo& candidate) { return candidate.name == "GPU"; });
  EXPECT_EQ(other.index, 3U);
  EXPECT_THAT(other.remark, HasSubstr("vulkan:2 (GPU) is left out"));
  const DeviceChoice cpu = choose_device({}, kMixed, [](const VulkanDeviceInfo&) { return true; });
  EXPECT_EQ(cpu.index, std::nullopt);
  EXPECT_EQ(choose_device(parse_device_name("vulkan:2"), kMixed, [](const VulkanDeviceInfo&) { return true; }).index,
            2U)
      << "a device that is named is taken";
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

TEST_F(CacheTest, StandsInTheHomeFolderOtherwise) {
  set("HOME", work_.string());
  for (const std::optional<std::string>& unusable : {std::optional<std::string>(), {""}, {"relative"}}) {
    set("XDG_CACHE_HOME", unusable);
    EXPECT_EQ(cache_folder().path, (work_ / ".cache" / "gdtslam").string());
  }
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

TEST_F(CacheTest, RecordsAreFoundForTheSameDeviceDriverAndShadersOnly) {
  const VerifyRecords records(work_.string(), "shaders");
  VulkanDeviceInfo gpu = device(0, "GPU", "discrete");
  EXPECT_EQ(records.find(gpu), std::nullopt);
  records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 0});
  records.keep(device(1, "Other GPU", "discrete"), {"2026-01-02T03:04:06Z", 10, 2, 3});
  ASSERT_TRUE(records.find(gpu));
  EXPECT_EQ(records.find(gpu)->date, "2026-01-02T03:04:05Z");
  EXPECT_EQ(records.find(gpu)->cases, 10U);
  EXPECT_EQ(records.find(gpu)->logs, 2U);
  EXPECT_TRUE(records.find(gpu)->passed());
  EXPECT_FALSE(records.find(device(1, "Other GPU", "discrete"))->passed());
  EXPECT_EQ(VerifyRecords(work_.string(), "other shaders").find(gpu), std::nullopt);
  gpu.driver = "driver 2";
  EXPECT_EQ(records.find(gpu), std::nullopt);
}

TEST_F(CacheTest, EqualDevicesHaveEachTheirOwnRecord) {
  const VerifyRecords records(work_.string(), "shaders");
  VulkanDeviceInfo one = device(0, "GPU", "discrete");
  VulkanDeviceInfo other = device(1, "GPU", "discrete");
  one.uuid = "00112233445566778899aabbccddeeff";
  other.uuid = "ffeeddccbbaa99887766554433221100";
  records.keep(other, {"2026-01-02T03:04:05Z", 10, 2, 7});
  EXPECT_EQ(records.find(one), std::nullopt) << "a fault of another";
  records.keep(one, {"2026-01-03T03:04:05Z", 11, 2, 0});
  ASSERT_TRUE(records.find(other)) << "wiped by another";
  EXPECT_EQ(records.find(other)->differences, 7U);
  one.index = 5;
  EXPECT_TRUE(records.find(one)) << "another number, as when a device before it is taken out";
}

TEST_F(CacheTest, RecordsThatAreKeptAtOnceAreAllKept) {
  const VerifyRecords records(work_.string(), "shaders");
  constexpr unsigned kEach = 40;
  const auto keep = [&](const std::string& name) {
    for (unsigned k = 0; k < kEach; ++k) {
      records.keep(device(k, name + std::to_string(k), "discrete"), {"2026-01-02T03:04:05Z", 10, 2, 0});
    }
  };
  std::thread other(keep, "other ");
  keep("one ");
  other.join();
  for (unsigned k = 0; k < kEach; ++k) {
    for (const char* name : {"one ", "other "}) {
      EXPECT_TRUE(records.find(device(k, name + std::to_string(k), "discrete"))) << name << k;
    }
  }
}

TEST_F(CacheTest, TheLastRecordOfADeviceCounts) {
  const VerifyRecords records(work_.string(), "shaders");
  const VulkanDeviceInfo gpu = device(0, "GPU", "discrete");
  records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 7});
  records.keep(gpu, {"2026-01-03T03:04:05Z", 11, 2, 0});
  EXPECT_EQ(records.find(gpu)->cases, 11U);
}

TEST_F(CacheTest, ADeviceThatFailedHasNotPassed) {
  const VerifyRecords records(work_.string(), "shaders");
  const VulkanDeviceInfo gpu = device(0, "GPU", "discrete");
  records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 0});
  records.keep(gpu, {"2026-01-03T03:04:05Z", 0, 0, 0, "GPU: vkQueueSubmit gave ErrorDeviceLost"});
  ASSERT_TRUE(records.find(gpu));
  EXPECT_FALSE(records.find(gpu)->passed());
  EXPECT_EQ(records.find(gpu)->failure, "GPU: vkQueueSubmit gave ErrorDeviceLost");
}

TEST_F(CacheTest, ADamagedFileOfRecordsIsAsGoodAsNone) {
  const VerifyRecords records(work_.string(), "shaders");
  const VulkanDeviceInfo gpu = device(0, "GPU", "discrete");
  records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 0});
  const std::string file = (work_ / "verify.json").string();
  std::string whole;
  {
    std::ifstream input(file);
    whole.assign(std::istreambuf_iterator<char>(input), {});
  }
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("{\"format\": 1, \"results\": []}"),
        std::string("{\"format\": 2, \"results\": 5}"), std::string("{\"format\": 2, \"results\": [5, {}]}"),
        whole.substr(0, whole.size() / 2)}) {
    std::ofstream(file, std::ios::trunc) << text;
    EXPECT_EQ(records.find(gpu), std::nullopt) << text;
    records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 0});
    EXPECT_TRUE(records.find(gpu)) << "after " << text;
  }
}

TEST_F(CacheTest, WithoutAFolderNothingIsKept) {
  const VerifyRecords records("", "shaders");
  const VulkanDeviceInfo gpu = device(0, "GPU", "discrete");
  records.keep(gpu, {"2026-01-02T03:04:05Z", 10, 2, 0});
  EXPECT_EQ(records.find(gpu), std::nullopt);
}

TEST(ShaderDigest, ChangesWithNamesAndWords) {
  const std::vector<std::uint32_t> one{1, 2, 3};
  const std::vector<std::uint32_t> two{1, 2, 4};
  const auto digest = [](std::string_view name, const std::vector<std::uint32_t>& words) {
    const ShaderModule shader{"kernel", name, words};
    return digest_of(std::span(&shader, 1));
  };
  EXPECT_EQ(digest("a", one), digest("a", one));
  EXPECT_NE(digest("a", one), digest("b", one));
  EXPECT_NE(digest("a", one), digest("a", two));
  EXPECT_NE(digest_of({}), digest("a", one));
}

}  // namespace
}  // namespace gdtslam
