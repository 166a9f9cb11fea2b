// Which device is taken, what the listing says, the pipeline cache, shaders that are changed, and the validation
// layers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "gdtslam/core/error.hpp"
#include "small_job.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class Options : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

TEST_F(Options, TheListingDescribesWhatIsThere) {
  const VulkanListing listing = list_vulkan_devices();
  EXPECT_TRUE(listing.problem.empty()) << listing.problem;
  ASSERT_FALSE(listing.devices.empty());
  for (std::size_t i = 0; i < listing.devices.size(); ++i) {
    const VulkanDeviceInfo& device = listing.devices[i];
    EXPECT_EQ(device.index, i);
    EXPECT_FALSE(device.name.empty());
    EXPECT_GT(device.memory_bytes, 0U);
    EXPECT_GE(device.max_group_invocations, 128U);
    EXPECT_GE(device.max_push_constant_bytes, 128U);
    EXPECT_GE(device.shared_memory_bytes, 16384U);
  }
  const VulkanDeviceInfo& tested = *find_test_device().device;
  if (tested.kind == "lavapipe") {
    EXPECT_THAT(tested.name, HasSubstr("llvmpipe"));
    EXPECT_FALSE(tested.is_hardware());
    EXPECT_TRUE(tested.problem.empty());
    EXPECT_GE(tested.max_storage_buffer_bytes, std::size_t{1} << 27U);
  }
}

TEST_F(Options, ADeviceThatIsNotThereIsRefusedWithTheListOfThoseThatAre) {
  const auto make = [] { make_vulkan_backend({.index = 99}); };
  EXPECT_THAT(
      make, ThrowsMessage<UnavailableError>(AllOf(HasSubstr("vulkan:99"), HasSubstr(find_test_device().device->name))));
}

TEST_F(Options, WithoutAnIndexOnlyAHardwareGpuWillDo) {
  bool has_gpu = false;
  for (const VulkanDeviceInfo& device : list_vulkan_devices().devices) {
    has_gpu = has_gpu || (device.is_hardware() && device.problem.empty());
  }
  if (has_gpu) {
    EXPECT_TRUE(make_vulkan_backend({})->vulkan_device().is_hardware());
  } else {
    const auto make = [] { make_vulkan_backend({}); };
    EXPECT_THAT(make, ThrowsMessage<UnavailableError>(HasSubstr("no hardware GPU")));
  }
}

TEST_F(Options, WithoutADriverVulkanIsUnavailableAndSaysSo) {
  const char* const set = std::getenv("VK_DRIVER_FILES");  // read by the loader
  const std::optional<std::string> before = set == nullptr ? std::nullopt : std::optional<std::string>(set);
  setenv("VK_DRIVER_FILES", "/nonexistent/driver.json", 1);
  const VulkanListing listing = list_vulkan_devices();
  const auto make = [] { make_vulkan_backend({.index = 0}); };
  EXPECT_TRUE(listing.devices.empty());
  EXPECT_THAT(listing.problem, HasSubstr("no driver"));
  EXPECT_THAT(make, ThrowsMessage<UnavailableError>(HasSubstr("no driver")));
  before ? setenv("VK_DRIVER_FILES", before->c_str(), 1) : unsetenv("VK_DRIVER_FILES");
  EXPECT_FALSE(list_vulkan_devices().devices.empty());
}

class PipelineCache : public Options {
 protected:
  void SetUp() override {
    Options::SetUp();
    folder = fs::temp_directory_path() / ("gdtslam_pipeline_cache_" + std::to_string(getpid()));
    fs::remove_all(folder);
    options.cache_folder = folder.string();
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path only_file() const {
    fs::path found;
    for (const auto& entry : fs::directory_iterator(folder)) {
      EXPECT_TRUE(found.empty()) << "two files: " << found << ", " << entry.path();
      found = entry.path();
    }
    return found;
  }
  /// Runs the job, with the right result whatever the cache holds; whether the cache was taken.
  bool works_with_cache() const {
    const auto backend = test_backend(options);
    EXPECT_EQ(run_job(*backend, 2), run_job(*make_cpu_backend({}), 2));
    return backend->cache_was_loaded();
  }
  fs::path folder;
  VulkanOptions options;
};

TEST_F(PipelineCache, IsWrittenAndTakenTheNextTime) {
  EXPECT_FALSE(works_with_cache());
  EXPECT_GT(fs::file_size(only_file()), 24U);
  EXPECT_TRUE(works_with_cache());
}

TEST_F(PipelineCache, ADamagedFileIsIgnoredAndReplaced) {
  EXPECT_FALSE(works_with_cache());
  const fs::path file = only_file();
  const auto size = fs::file_size(file);
  const auto spoil = [&](auto how) {
    how();
    EXPECT_FALSE(works_with_cache());
    EXPECT_TRUE(works_with_cache()) << "it was not replaced";
  };
  const auto flip = [&](std::uintmax_t at) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(at));
    const int byte = stream.get();
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(static_cast<char>(byte ^ 0x40));
  };
  spoil([&] { fs::resize_file(file, size / 2); });
  spoil([&] { fs::resize_file(file, 0); });
  spoil([&] { std::ofstream(file, std::ios::app) << "more"; });
  for (const std::uintmax_t at : {std::uintmax_t{0}, std::uintmax_t{8}, std::uintmax_t{15}, std::uintmax_t{20},
                                  std::uintmax_t{24}, std::uintmax_t{45}, size - 1}) {
    spoil([&] { flip(at); });
  }
}

TEST_F(PipelineCache, AFolderThatCannotBeWrittenCostsNothingButTheCache) {
  std::ofstream(folder.string()) << "a file where the folder should be";
  const auto backend = test_backend(options);
  EXPECT_EQ(run_job(*backend, 1), run_job(*make_cpu_backend({}), 1));
  EXPECT_FALSE(backend->save_cache());
}

TEST_F(PipelineCache, WithoutAFolderNothingIsWritten) {
  const auto backend = test_backend();
  run_job(*backend, 1);
  EXPECT_TRUE(backend->save_cache());
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(Options, AChangedShaderChangesTheResult) {
  std::vector<std::string> names;
  VulkanOptions options;
  options.edit_shader = [&](std::string_view name, std::vector<std::uint32_t>& spirv) {
    names.emplace_back(name);
    if (!name.starts_with("gdt_merge")) return;
    for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16U) {
      if ((spirv[at] & 0xFFFFU) == 194)
        spirv[at] = spirv[at] - 194 + 196;  // a shift to the right becomes one to the left
    }
  };
  const auto backend = test_backend(options);
  EXPECT_NE(run_job(*backend, 3), run_job(*make_cpu_backend({}), 3));
  EXPECT_EQ(names.size(), 4U) << "each variant is built once";
}

class Validation : public Options {
 protected:
  void SetUp() override {
    Options::SetUp();
    GDTSLAM_NEEDS_VALIDATION();
    options.validation = true;
  }
  VulkanOptions options;
};

TEST_F(Validation, FindsNothingToSayAboutTheBackend) {
  const auto backend = test_backend(options);
  EXPECT_EQ(run_job(*backend, 8), run_job(*make_cpu_backend({}), 8));
  const Buffer large = backend->allocate(std::size_t{9} << 20U);
  backend->upload(large, std::vector<std::byte>(large.bytes(), std::byte{1}));
  std::vector<std::byte> found(large.bytes());
  backend->download(large, found);
  backend->flush();
}

/// A deliberate fault: a shader whose binding is another must be reported, and ends the backend.
TEST_F(Validation, SpeaksUpAboutAShaderThatDoesNotFit) {
  options.edit_shader = [](std::string_view, std::vector<std::uint32_t>& spirv) {
    for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16U) {
      const bool is_binding = (spirv[at] & 0xFFFFU) == 71 && spirv[at + 2] == 33;
      if (is_binding && spirv[at + 3] == 1) spirv[at + 3] = 7;
    }
  };
  const auto backend = test_backend(options);
  try {
    run_job(*backend, 1);
    FAIL() << "no message";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.call(), "validation");
    EXPECT_THAT(error.result(), HasSubstr("VUID"));
  }
  EXPECT_THROW(backend->flush(), DeviceError);
}

/// Every kernel's smaller cases: no message of validation or synchronisation validation.
TEST_F(Validation, FindsNothingToSayAboutTheKernels) {
  constexpr std::size_t kCasesOfAKernel = 40;
  const auto backend = test_backend(options);
  std::map<std::string_view, std::size_t> tried;
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark || ++tried[source.kernel->name] > kCasesOfAKernel) continue;
    ASSERT_NO_THROW(run_case(*backend, source.make())) << source.kernel->name << " " << source.name;
  }
  ASSERT_NO_THROW(backend->flush());
  EXPECT_EQ(tried.size(), kernel_registry().size());
}

}  // namespace
}  // namespace gdtslam::test
