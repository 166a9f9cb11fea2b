// Devices that offer less than the one at hand, rehearsed by VulkanOptions::edit_device: other variants, the same
// bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/core/error.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::Contains;

constexpr std::uint32_t kSmallWidth = 61;
constexpr std::uint32_t kSmallStride = 64;
constexpr std::uint32_t kSmallHeight = 47;
constexpr std::uint32_t kSmallPoints = 90;
constexpr std::uint32_t kSmallCandidates = 70;

/// Costs of poses on a field of noise: the smallest job that reads a field.
class LookUps {
 public:
  explicit LookUps(Backend& backend, std::uint32_t fill = 0x00500123)
      : backend_(backend),
        field_(backend.allocate(kFieldBytes)),
        points_(backend.allocate(kSmallPoints * sizeof(PointCells))),
        candidates_(backend.allocate(kSmallCandidates * sizeof(PoseCandidate))) {
    std::vector<PointCells> points(kSmallPoints);
    std::vector<PoseCandidate> candidates(kSmallCandidates);
    for (std::uint32_t i = 0; i < kSmallPoints; ++i) {
      points[i] = {static_cast<float>(i * 37 % 29) - 14.0F, static_cast<float>(i * 11 % 23) - 11.5F};
    }
    for (std::uint32_t i = 0; i < kSmallCandidates; ++i) {
      const auto at = static_cast<float>(i);
      candidates[i] = {.x = 30.0F + at * 0.13F, .y = 23.0F - at * 0.17F, .theta = at * 0.01F, .bias = i};
    }
    backend.upload(points_, std::as_bytes(std::span(points)));
    backend.upload(candidates_, std::as_bytes(std::span(candidates)));
    write_field(fill);
  }

  /// Another field: values that differ from cell to cell.
  void write_field(std::uint32_t seed) {
    std::vector<std::uint32_t> words(kFieldBytes / 4);
    for (std::size_t i = 0; i < words.size(); ++i) {
      seed = seed * 1664525U + 1013904223U;
      words[i] = seed >> 3U & 0x0FFF0FFFU;
    }
    backend_.upload(field_, std::as_bytes(std::span(words)));
  }
  /// The costs, on their way.
  PendingDownload start() {
    cost_ = backend_.allocate(kSmallCandidates * sizeof(std::uint32_t));
    run<PoseCost>(backend_,
                  {.width = kSmallWidth,
                   .height = kSmallHeight,
                   .stride = kSmallStride,
                   .point_count = kSmallPoints,
                   .cap = 5120},
                  {kSmallCandidates, 1, 1}, field_, points_, candidates_, cost_);
    return backend_.start_download(cost_, cost_.bytes());
  }
  std::vector<std::byte> finish(const PendingDownload& download) {
    std::vector<std::byte> found(kSmallCandidates * sizeof(std::uint32_t));
    backend_.finish_download(download, found);
    return found;
  }
  std::vector<std::byte> run_once() { return finish(start()); }
  void release_field() { field_ = {}; }
  void copy_field(VulkanBackend& backend) {
    Buffer other = backend.allocate(kFieldBytes);
    backend.copy(field_, other);
    field_ = std::move(other);
  }

  static constexpr std::size_t kFieldBytes = std::size_t{kSmallStride} * kSmallHeight * 2;

 private:
  Backend& backend_;
  Buffer field_;
  Buffer points_;
  Buffer candidates_;
  Buffer cost_;
};

std::vector<std::byte> costs_of_cpu(std::uint32_t fill = 0x00500123) {
  const auto cpu = make_cpu_backend({});
  return LookUps(*cpu, fill).run_once();
}

/// Backends that note the names of the shaders they build.
class LesserDevices : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
  std::unique_ptr<VulkanBackend> backend(ShaderVariants variants, std::size_t texel_words) {
    shaders.clear();
    VulkanOptions options;
    options.variants = variants;
    options.edit_shader = [this](std::string_view name, std::vector<std::uint32_t>&) { shaders.emplace(name); };
    options.edit_device = [texel_words](VulkanDeviceInfo& device) { device.max_texel_words = texel_words; };
    return test_backend(options);
  }
  std::set<std::string> shaders;
};

TEST_F(LesserDevices, EveryDeviceReadsSomeTexels) {
  EXPECT_GE(test_backend()->vulkan_device().max_texel_words, 65536U);  // the least that Vulkan allows
}

TEST_F(LesserDevices, AFieldIsReadAsTexelsUpToTheDevicesLargest) {
  const std::size_t words = (LookUps::kFieldBytes + 15) / 16 * 4;
  const auto expected = costs_of_cpu();
  EXPECT_EQ(LookUps(*backend(ShaderVariants::kNarrow, words)).run_once(), expected);
  EXPECT_THAT(shaders, Contains("pose_cost_narrow"));
  for (const std::size_t less : {words - 1, std::size_t{0}}) {
    EXPECT_EQ(LookUps(*backend(ShaderVariants::kNarrow, less)).run_once(), expected);
    EXPECT_EQ(shaders, std::set<std::string>{"pose_cost_wide"}) << less;
  }
}

/// The field as an upload, a kernel's shader and a copy leave it, and again: what is read through a texel buffer waits.
TEST_F(LesserDevices, TexelsAreWhatWasWrittenLast) {
  const auto device = backend(ShaderVariants::kNarrow, 1U << 20U);
  LookUps look_ups(*device);
  std::vector<PendingDownload> downloads;
  for (const std::uint32_t fill : {3U, 4U, 5U}) {
    look_ups.write_field(fill);
    downloads.push_back(look_ups.start());
  }
  look_ups.copy_field(*device);
  downloads.push_back(look_ups.start());
  for (std::uint32_t i = 0; i < downloads.size(); ++i) {
    EXPECT_EQ(look_ups.finish(downloads[i]), costs_of_cpu(std::min(3 + i, 5U))) << i;
  }
  EXPECT_NE(costs_of_cpu(3), costs_of_cpu(4));
}

/// A view goes with its buffer, and both only when the device is done with them.
TEST_F(LesserDevices, AFieldMayBeReleasedWhileItIsRead) {
  VulkanOptions options;
  options.variants = ShaderVariants::kNarrow;
  const auto device = test_backend(options);
  for (std::uint32_t round = 0; round < 20; ++round) {
    LookUps look_ups(*device, round);
    const PendingDownload download = look_ups.start();
    if (round % 2 == 0) device->flush();
    look_ups.release_field();
    const Buffer other = device->allocate(LookUps::kFieldBytes);
    device->fill(other, 0);
    EXPECT_EQ(look_ups.finish(download), costs_of_cpu(round)) << round;
  }
}

/// One view a buffer, however often it is read; the call that makes it can fail like every other.
TEST_F(LesserDevices, AViewIsMadeOnceAndMayFail) {
  const auto device = backend(ShaderVariants::kNarrow, 1U << 20U);
  LookUps first(*device);
  first.run_once();
  LookUps second(*device);
  const std::uint64_t before = device->call_count();
  const auto costs = second.start();
  const std::uint64_t made = device->call_count();
  second.start();
  EXPECT_EQ(made - before, (device->call_count() - made) + 1);
  second.finish(costs);

  std::size_t failed = 0;
  for (std::uint64_t k = 1; k < 200 && failed == 0; ++k) {
    VulkanOptions options;
    options.variants = ShaderVariants::kNarrow;
    options.fault = {k, VulkanFault::Code::kOutOfDeviceMemory};
    std::unique_ptr<VulkanBackend> faulty;
    try {
      faulty = test_backend(options);
      LookUps(*faulty).run_once();
    } catch (const DeviceError& error) {
      if (error.call() != "vkCreateBufferView") continue;
      ++failed;
      EXPECT_EQ(error.result(), "ErrorOutOfDeviceMemory");
      EXPECT_THROW(faulty->flush(), DeviceError);
      EXPECT_EQ(faulty->submit_count(), 0U);
    }
  }
  EXPECT_EQ(failed, 1U);
}

/// Work groups of no more than every device runs: the variant of larger ones gives way.
TEST_F(LesserDevices, SmallGroupsGiveTheSameBytes) {
  VulkanOptions options;
  options.variants = ShaderVariants::kWide;
  options.edit_shader = [this](std::string_view name, std::vector<std::uint32_t>&) { shaders.emplace(name); };
  options.edit_device = [](VulkanDeviceInfo& device) { device.max_group_invocations = 128; };
  const auto cpu = make_cpu_backend({});
  const auto device = test_backend(options);
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.kernel->name != "smallest_values" || source.large) continue;
    const KernelCase kernel_case = source.make();
    const CaseOutcome found = run_case(*device, kernel_case);
    ASSERT_FALSE(difference(kernel_case, run_case(*cpu, kernel_case), found)) << source.name;
    ASSERT_TRUE(found.guards_intact && found.inputs_intact) << source.name;
  }
  EXPECT_EQ(shaders, std::set<std::string>{"smallest_values"});
}

TEST_F(LesserDevices, ThatRunNoGroupOfAKernelAreRefused) {
  VulkanOptions options;
  options.edit_device = [](VulkanDeviceInfo& device) { device.max_group_invocations = 4; };
  const auto device = test_backend(options);
  try {
    LookUps(*device).run_once();
    FAIL() << "a group of more invocations than the device runs";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.call(), "kernel pose_cost");
    EXPECT_THAT(error.result(), testing::HasSubstr("or 4 in all"));
  }
}

}  // namespace
}  // namespace gdtslam::test
