// Fill and downloads of the CPU backend: what a device must do as well (tests/equivalence/vulkan).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::Each;

std::vector<std::uint8_t> bytes_of(Backend& backend, const Buffer& buffer) {
  std::vector<std::uint8_t> bytes(buffer.bytes());
  backend.download(buffer, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

TEST(Fill, SetsEveryWordAndTheBytesBeyondTheLastWholeOne) {
  const auto backend = make_cpu_backend({});
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{5},
                                  std::size_t{1000}, std::size_t{1002}, std::size_t{4099}}) {
    const Buffer before = backend->allocate(8);
    const Buffer buffer = backend->allocate(bytes);
    const Buffer after = backend->allocate(8);
    backend->fill(buffer, 0xD4C3B2A1U);
    const std::vector<std::uint8_t> found = bytes_of(*backend, buffer);
    constexpr std::array<std::uint8_t, 4> kWord{0xA1, 0xB2, 0xC3, 0xD4};  // little-endian, as on every device
    for (std::size_t i = 0; i < bytes; ++i) {
      ASSERT_EQ(found[i], kWord[i % 4]) << i << " of " << bytes;
    }
    EXPECT_THAT(bytes_of(*backend, before), Each(0));
    EXPECT_THAT(bytes_of(*backend, after), Each(0));
  }
  EXPECT_THROW(backend->fill(Buffer{}, 1), Error);
  EXPECT_THROW(backend->fill(make_cpu_backend({})->allocate(4), 1), Error);
}

/// A field of one row, and a kernel that overwrites another buffer with a cap.
class Downloads : public testing::Test {
 protected:
  std::unique_ptr<Backend> backend = make_cpu_backend({});
  Buffer buffer = backend->allocate(64);
  Buffer nothing = backend->allocate(0);

  void write(std::uint32_t cap) {
    run<FieldGrow>(*backend, {.width = 32, .height = 1, .stride = 32, .cap = cap}, {32, 1, 1}, nothing, buffer);
  }
  std::vector<std::uint16_t> finish(PendingDownload download) {
    std::vector<std::uint16_t> values(download.bytes / 2);
    backend->finish_download(download, std::as_writable_bytes(std::span(values)));
    return values;
  }
};

TEST_F(Downloads, SeeWhatWasAskedForBeforeAndNothingLater) {
  write(1);
  const PendingDownload first = backend->start_download(buffer, 64);
  write(2);
  const PendingDownload second = backend->start_download(buffer, 8, 6);
  backend->fill(buffer, 0x00030003U);
  const PendingDownload third = backend->start_download(buffer, 64);
  const std::vector<std::uint16_t> upload(32, 4);
  backend->upload(buffer, std::as_bytes(std::span(upload)));
  EXPECT_EQ(second.bytes, 8U);
  // In any order.
  EXPECT_EQ(finish(third), std::vector<std::uint16_t>(32, 3));
  EXPECT_EQ(finish(first), std::vector<std::uint16_t>(32, 1));
  EXPECT_EQ(finish(second), std::vector<std::uint16_t>(4, 2));
}

TEST_F(Downloads, OutliveTheirBuffer) {
  PendingDownload pending;
  {
    const Buffer gone = backend->allocate(4);
    backend->fill(gone, 0x00070007U);
    pending = backend->start_download(gone, 4);
  }
  EXPECT_EQ(finish(pending), std::vector<std::uint16_t>(2, 7));
}

TEST_F(Downloads, AreDeliveredOnceAndWithTheirSize) {
  const PendingDownload pending = backend->start_download(buffer, 64);
  std::vector<std::byte> data(64);
  EXPECT_THROW(backend->finish_download(pending, std::span(data).first(63)), Error);
  EXPECT_THROW(backend->finish_download(pending, {}), Error);
  EXPECT_NO_THROW(backend->finish_download(pending, data)) << "an error must not have used it up";
  EXPECT_THROW(backend->finish_download(pending, data), Error);
  EXPECT_THROW(backend->finish_download({}, {}), Error);
  EXPECT_THROW(backend->finish_download({.id = 12345, .bytes = 64}, data), Error);
}

TEST_F(Downloads, BeyondTheBufferAreRefused) {
  EXPECT_THROW(backend->start_download(buffer, 65), Error);
  EXPECT_THROW(backend->start_download(buffer, 4, 61), Error);
  EXPECT_THROW(backend->start_download(buffer, 4, static_cast<std::size_t>(-2)), Error);
  EXPECT_THROW(backend->start_download(Buffer{}, 0), Error);
  EXPECT_TRUE(finish(backend->start_download(buffer, 0, 64)).empty());
}

TEST_F(Downloads, TheProcessorWorksAtOnceAndSubmitsNothing) {
  write(9);
  backend->flush();
  write(9);
  EXPECT_EQ(backend->dispatch_count(), 2U);
  EXPECT_EQ(backend->submit_count(), 0U);
}

std::uint64_t calls_during(const std::function<void()>& work) {
  const std::uint64_t before = cpu_kernel_calls();
  work();
  return cpu_kernel_calls() - before;
}

TEST(KernelCalls, CountDispatchesAndDirectCallsOfEveryThread) {
  const auto backend = make_cpu_backend({});
  const Buffer field = backend->allocate(64);
  const Buffer nothing = backend->allocate(0);
  const auto grow = [&] {
    run<FieldGrow>(*backend, {.width = 32, .height = 1, .stride = 32}, {32, 1, 1}, nothing, field);
  };
  EXPECT_EQ(calls_during(grow), 1U);
  const auto cost = [] {
    const std::uint16_t cells[8] = {};
    pose_cost_host(Isa::kBaseline, {.width = 2, .height = 2, .stride = 4}, cells, nullptr, nullptr, 0, nullptr);
  };
  EXPECT_EQ(calls_during(cost), 1U);
  EXPECT_EQ(calls_during([] {}), 0U);
  const auto transfers = [&] {
    backend->fill(field, 1);
    bytes_of(*backend, field);
  };
  EXPECT_EQ(calls_during(transfers), 0U);
  const auto on_threads = [&] {  // threads that have ended keep their counts, and their places are used again
    for (int round = 0; round < 3; ++round) {
      std::thread one([&] { cost(); });
      std::thread two([&] { cost(), cost(); });
      one.join();
      two.join();
    }
  };
  EXPECT_EQ(calls_during(on_threads), 9U);
}

TEST(KernelCalls, CountSlicesOfADispatch) {
  const auto backend = make_cpu_backend({.threads = 3, .isa = std::nullopt});
  const Buffer field = backend->allocate(2 * 1024 * 1024);
  const Buffer nothing = backend->allocate(0);
  const auto grow = [&] {
    run<FieldGrow>(*backend, {.width = 1024, .height = 1024, .stride = 1024}, {1024, 1024, 1}, nothing, field);
  };
  EXPECT_GT(calls_during(grow), 1U);
}

}  // namespace
}  // namespace gdtslam::test
