// Copies between two buffers of a device.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam {
namespace {

std::vector<std::byte> counted(std::size_t bytes, unsigned first) {
  std::vector<std::byte> values(bytes);
  for (std::size_t i = 0; i < bytes; ++i) values[i] = static_cast<std::byte>(first + i);
  return values;
}

TEST(VulkanCopy, CopiesWhatWasThereAtItsTurn) {
  GDTSLAM_NEEDS_VULKAN();
  const std::unique_ptr<VulkanBackend> device = test::test_backend({.validation = true});
  for (const std::size_t bytes : {1U, 4U, 7U, 4096U, 1000003U}) {
    const Buffer a = device->allocate(bytes);
    const Buffer b = device->allocate(bytes);
    const std::vector<std::byte> before = counted(bytes, 3);
    const std::vector<std::byte> after = counted(bytes, 77);
    std::vector<std::byte> found(bytes);
    device->upload(a, before);
    device->copy(a, b);
    device->upload(a, after);  // behind the copy
    device->download(b, found);
    EXPECT_EQ(found, before) << bytes << " bytes";
    device->copy(b, a);
    device->download(a, found);
    EXPECT_EQ(found, before) << bytes << " bytes, back";
  }
}

TEST(VulkanCopy, OfNewMemoryGivesZeros) {
  GDTSLAM_NEEDS_VULKAN();
  const std::unique_ptr<VulkanBackend> device = test::test_backend({.validation = true});
  const Buffer a = device->allocate(64);
  const Buffer b = device->allocate(64);
  std::vector<std::byte> found = counted(64, 1);
  device->upload(b, found);
  device->copy(a, b);
  device->download(b, found);
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](std::byte value) { return value == std::byte{0}; }));
}

TEST(VulkanCopy, RefusesBuffersThatDoNotFit) {
  GDTSLAM_NEEDS_VULKAN();
  const std::unique_ptr<VulkanBackend> device = test::test_backend();
  const Buffer a = device->allocate(64);
  const Buffer b = device->allocate(68);
  EXPECT_THROW(device->copy(a, b), Error);
  EXPECT_THROW(device->copy(a, a), Error);
}

}  // namespace
}  // namespace gdtslam
