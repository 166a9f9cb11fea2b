// What goes up comes down: sizes, offsets, more than the staging memory holds, and the order of the verbs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::byte> noise(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(random.bits() >> 56U);
  }
  return bytes;
}

bool is_all(const std::vector<std::byte>& bytes, unsigned value) {
  return std::all_of(bytes.begin(), bytes.end(), [value](std::byte b) { return b == static_cast<std::byte>(value); });
}

class Transfers : public testing::Test {
 protected:
  void SetUp() override {
    GDTSLAM_NEEDS_VULKAN();
    backend = test_backend();
  }
  std::vector<std::byte> content(const Buffer& buffer) {
    std::vector<std::byte> bytes(buffer.bytes());
    backend->download(buffer, bytes);
    return bytes;
  }
  std::unique_ptr<VulkanBackend> backend;
};

TEST_F(Transfers, EverySizeComesBackAsItWent) {
  for (std::size_t bytes = 0; bytes <= 70; ++bytes) {
    const Buffer buffer = backend->allocate(bytes);
    const auto data = noise(bytes, bytes);
    backend->upload(buffer, data);
    EXPECT_EQ(content(buffer), data) << bytes << " bytes";
  }
}

TEST_F(Transfers, PartsGoWhereTheyBelong) {
  constexpr std::size_t kBytes = 1003;
  std::vector<std::byte> expected(kBytes);
  const Buffer buffer = backend->allocate(kBytes);
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    const std::size_t offset = random.bits() % (kBytes + 1);
    const std::size_t bytes = random.bits() % (kBytes - offset + 1);
    const auto part = noise(bytes, static_cast<std::uint64_t>(round));
    backend->upload(buffer, part, offset);
    std::copy(part.begin(), part.end(), expected.begin() + static_cast<std::ptrdiff_t>(offset));
    if (round % 10 == 0) {
      const std::size_t from = random.bits() % (kBytes + 1);
      std::vector<std::byte> found(random.bits() % (kBytes - from + 1));
      backend->download(buffer, found, from);
      EXPECT_TRUE(std::equal(found.begin(), found.end(), expected.begin() + static_cast<std::ptrdiff_t>(from)));
    }
  }
  EXPECT_EQ(content(buffer), expected);
}

TEST_F(Transfers, MoreThanTheStagingMemoryIsCut) {
  constexpr std::size_t kBytes = (std::size_t{41} << 20U) + 5;  // some ten segments
  const auto data = noise(kBytes, 3);
  const Buffer buffer = backend->allocate(kBytes);
  backend->upload(buffer, data);
  EXPECT_TRUE(content(buffer) == data);
  const std::vector<std::byte> part(data.begin() + 1234567, data.end() - 7);
  std::vector<std::byte> found(part.size());
  backend->download(buffer, found, 1234567);
  EXPECT_TRUE(found == part);
}

TEST_F(Transfers, MemoryStartsAtZeroAlsoWhereItWasUsedBefore) {
  for (const std::size_t bytes : {1U, 4U, 100U, 4096U, 1000001U}) {
    for (int round = 0; round < 5; ++round) {
      const Buffer buffer = backend->allocate(bytes);
      EXPECT_TRUE(is_all(content(buffer), 0)) << bytes << " bytes, round " << round;
      backend->fill(buffer, 0xFFFFFFFFU);
      EXPECT_TRUE(is_all(content(buffer), 0xFF));
    }
  }
}

TEST_F(Transfers, APartOfAFreshBufferLeavesZerosAround) {
  {
    const Buffer dirty = backend->allocate(64);
    backend->fill(dirty, 0xABABABABU);
    EXPECT_TRUE(is_all(content(dirty), 0xAB));
  }
  const Buffer buffer = backend->allocate(64);
  backend->upload(buffer, noise(4, 1), 8);
  auto found = content(buffer);
  const auto part = noise(4, 1);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), found.begin() + 8));
  std::fill(found.begin() + 8, found.begin() + 12, std::byte{0});
  EXPECT_TRUE(is_all(found, 0));
}

TEST_F(Transfers, FillSetsEveryByte) {
  const Buffer buffer = backend->allocate(11);
  backend->fill(buffer, 0x04030201U);
  const auto found = content(buffer);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i], static_cast<std::byte>(i % 4 + 1));
  }
}

TEST_F(Transfers, ADownloadSeesWhatWasAskedForBeforeIt) {
  const Buffer buffer = backend->allocate(16);
  std::vector<PendingDownload> downloads;
  for (std::uint32_t round = 0; round < 50; ++round) {
    backend->fill(buffer, round * 0x01010101U);
    downloads.push_back(backend->start_download(buffer, 16, 0));
    if (round % 7 == 0) {
      backend->flush();
    }
  }
  backend->fill(buffer, 0xEEEEEEEEU);
  for (std::uint32_t round = 50; round-- > 0;) {  // the last one first: those of old batches are kept for their time
    std::vector<std::byte> found(16);
    backend->finish_download(downloads[round], found);
    EXPECT_TRUE(is_all(found, round)) << "round " << round;
  }
}

TEST_F(Transfers, LargeDownloadsWaitForTheirTimeToo) {
  constexpr std::size_t kBytes = std::size_t{6} << 20U;
  const Buffer buffer = backend->allocate(kBytes);
  std::vector<PendingDownload> downloads;
  for (std::uint32_t round = 1; round <= 4; ++round) {
    backend->fill(buffer, round * 0x01010101U);
    downloads.push_back(backend->start_download(buffer, kBytes, 0));
  }
  std::vector<std::byte> found(kBytes);
  for (const std::uint32_t round : {2U, 4U, 1U, 3U}) {
    backend->finish_download(downloads[round - 1], found);
    EXPECT_TRUE(is_all(found, round)) << "round " << round;
  }
}

TEST_F(Transfers, AreRefusedWithTheWordsOfTheCpu) {
  const auto cpu = make_cpu_backend({});
  const auto refusal = [](Backend& device, auto action) -> std::string {
    try {
      action(device);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const std::vector<std::byte> data(4);
  const auto expect_alike = [&](auto action) {
    const std::string expected = refusal(*cpu, action);
    EXPECT_NE(expected, "no error");
    EXPECT_EQ(refusal(*backend, action), expected);
  };
  expect_alike([&](Backend& device) { device.upload(device.allocate(16), data, 13); });
  expect_alike([&](Backend& device) { device.upload(device.allocate(16), data, static_cast<std::size_t>(-2)); });
  expect_alike([&](Backend& device) { device.start_download(device.allocate(16), 11, 6); });
  expect_alike([&](Backend& device) { device.fill(Buffer{}, 1); });
  expect_alike([&](Backend& device) { static_cast<void>(device.host_view(Buffer{})); });
  expect_alike([&](Backend& device) {
    std::vector<std::byte> five(5);
    device.finish_download(device.start_download(device.allocate(16), 4, 0), five);
  });
  expect_alike([&](Backend& device) {
    std::vector<std::byte> four(4);
    const PendingDownload download = device.start_download(device.allocate(16), 4, 0);
    device.finish_download(download, four);
    device.finish_download(download, four);
  });
}

TEST_F(Transfers, ABufferBeyondTheLimitIsRefusedWithBothSizesAndEndsNothing) {
  const std::size_t allowed = backend->device().max_buffer_bytes;
  EXPECT_GE(allowed, std::size_t{1} << 27U);  // what Vulkan asks of every device
  const auto too_much = [&] { backend->allocate(allowed + 1); };
  EXPECT_THAT(too_much, ThrowsMessage<DeviceError>(
                            AllOf(HasSubstr(std::to_string(allowed + 1)), HasSubstr(std::to_string(allowed)))));
  EXPECT_THROW(backend->allocate(static_cast<std::size_t>(-1)), DeviceError);
  const Buffer buffer = backend->allocate(8);
  EXPECT_TRUE(is_all(content(buffer), 0));
}

TEST_F(Transfers, TheLargestBufferThatIsAllowedWorks) {
  // What a device may allow beyond a quarter of a gibibyte is taken off, so that the test fits every one.
  VulkanOptions options;
  options.edit_device = [](VulkanDeviceInfo& info) {
    info.max_storage_buffer_bytes = std::min<std::size_t>(info.max_storage_buffer_bytes, std::size_t{1} << 28U);
  };
  const auto limited = test_backend(options);
  const std::size_t allowed = limited->device().max_buffer_bytes;
  const Buffer buffer = limited->allocate(allowed);
  const auto data = noise(4096, 5);
  limited->upload(buffer, data, allowed - data.size());
  std::vector<std::byte> found(data.size());
  limited->download(buffer, found, allowed - data.size());
  EXPECT_EQ(found, data);
}

TEST_F(Transfers, HasNoViewOfTheMemoryForTheHost) {
  const Buffer buffer = backend->allocate(8);
  EXPECT_TRUE(backend->host_view(buffer).empty());
}

}  // namespace
}  // namespace gdtslam::test
