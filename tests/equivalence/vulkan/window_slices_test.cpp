// Windows that no buffer of the device holds: a device with little room gives the bits of the CPU, which has room for
// the windows in one piece, and does not fall back.
#include <gtest/gtest.h>

#include "gdtslam/compute/kernels/pose_lattice.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

/// The test device with buffers of so many bytes at most.
std::unique_ptr<VulkanBackend> small_device(std::size_t buffer_bytes) {
  VulkanOptions options;
  options.edit_device = [buffer_bytes](VulkanDeviceInfo& info) { info.max_storage_buffer_bytes = buffer_bytes; };
  return test_backend(std::move(options));
}

/// Windows of 13 x 13 poses and more at 100 angles and more.
MapperConfig finely_sampled() {
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.search.step_m = 0.05;
  config.search.step_rad = 0.0035;
  config.search.max_points = 16;
  config.search.starts = SmallestValues::kMost;
  return config;
}

/// What the map needs as it grows, and no window fits into.
std::size_t room_for(const MappedDrive& drive) {
  const std::size_t rows = static_cast<std::size_t>(drive.geometry.height);
  return 2 * rows * (static_cast<std::size_t>(drive.geometry.width) + 64) / 16 * 16;
}

TEST(VulkanWindowSlices, GiveTheBitsOfTheCpu) {
  GDTSLAM_NEEDS_VULKAN();
  const MapperConfig config = finely_sampled();
  const std::vector<DriveScan> scans = room_scans(16, 3);
  const auto cpu = make_cpu_backend({});
  const MappedDrive expected = map_drive(scans, config, *cpu);
  const auto device = small_device(room_for(expected));
  ASSERT_EQ(device->device().max_buffer_bytes, room_for(expected));
  const MappedDrive found = map_drive(scans, config, *device);
  expect_same(found, expected);
  EXPECT_EQ(found.loss, "");
  EXPECT_TRUE(found.warnings.empty());
  // A window that is cut is submitted in two parts at least.
  EXPECT_GE(found.statistics.submissions, 2 * found.statistics.attempts + found.statistics.keyframes);
}

// More layers than one submission takes, and more costs than a segment of the staging memory holds.
TEST(VulkanWindowSlices, ComeInSeveralSubmissions) {
  GDTSLAM_NEEDS_VULKAN();
  MapperConfig config = finely_sampled();
  config.search.step_m = 0.02;
  config.search.step_rad = 0.0007;
  config.search.max_points = 8;
  config.search.attempts = 1;
  const std::vector<DriveScan> scans = room_scans(3, 2);
  const auto cpu = make_cpu_backend({});
  const MappedDrive expected = map_drive(scans, config, *cpu);
  const auto device = small_device(room_for(expected));
  const MappedDrive found = map_drive(scans, config, *device);
  expect_same(found, expected);
  EXPECT_EQ(found.loss, "");
  EXPECT_GE(found.statistics.submissions, 3 * found.statistics.attempts + found.statistics.keyframes);
}

// Without slices a window at one angle is the least: more than that is refused before any scan.
TEST(VulkanWindowSlices, TooManyPosesAtOneAngleGoToTheCpuAtTheStart) {
  GDTSLAM_NEEDS_VULKAN();
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.search.step_m = 0.005;
  config.search.step_rad = 3.15;
  const auto device = small_device(900000);  // 241 x 241 poses are 929,296 bytes
  std::vector<std::string> warnings;
  const Mapper mapper(config, *device, {.fall_back = true, .cpu = {}, .warn = [&](const std::string& text) {
                                          warnings.push_back(text);
                                        }});
  EXPECT_TRUE(mapper.lost_device());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("search.max_half_width"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("929296 bytes"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace gdtslam::test
