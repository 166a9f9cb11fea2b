// Devices that offer less than the one at hand, rehearsed by VulkanOptions::edit_device: other variants, the same
// bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/core/error.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

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

class LesserDevices : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

/// The field as an upload, a kernel's shader and a copy leave it, and again.
TEST_F(LesserDevices, AFieldIsReadAsItWasWrittenLast) {
  const auto device = test_backend();
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

/// Memory goes only when the device is done with it.
TEST_F(LesserDevices, AFieldMayBeReleasedWhileItIsRead) {
  const auto device = test_backend();
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

/// Work groups of no more than every device runs: the variant of larger ones gives way.
TEST_F(LesserDevices, SmallGroupsGiveTheSameBytes) {
  VulkanOptions options;
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
