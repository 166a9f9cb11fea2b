#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::byte> bytes_from(std::size_t count, unsigned start) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) {
    bytes[i] = static_cast<std::byte>(start + i);
  }
  return bytes;
}

TEST(CpuBackend, MemoryStartsAtZeroAlsoWhereItWasUsedBefore) {
  const auto backend = make_cpu_backend({});
  for (int round = 0; round < 20; ++round) {
    const Buffer buffer = backend->allocate(10000);
    const auto view = backend->host_view(buffer);
    ASSERT_EQ(view.size(), 10000U);
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(view.data()) % 64, 0U);
    ASSERT_TRUE(std::all_of(view.begin(), view.end(), [](std::byte b) { return b == std::byte{0}; }));
    std::fill(view.begin(), view.end(), std::byte{0xFF});
  }
}

TEST(CpuBackend, UploadAndDownloadAtOffsets) {
  const auto backend = make_cpu_backend({});
  const Buffer buffer = backend->allocate(16);
  backend->upload(buffer, bytes_from(4, 1), 5);
  std::vector<std::byte> found(6);
  backend->download(buffer, found, 4);
  EXPECT_EQ(found, (std::vector<std::byte>{std::byte{0}, std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4},
                                           std::byte{0}}));
  backend->upload(buffer, {}, 16);
  EXPECT_THAT([&] { backend->upload(buffer, bytes_from(4, 1), 13); },
              ThrowsMessage<Error>(AllOf(HasSubstr("4 bytes"), HasSubstr("offset 13"), HasSubstr("16 bytes"))));
  EXPECT_THROW(backend->download(buffer, found, 11), Error);
  EXPECT_THROW(backend->download(buffer, found, static_cast<std::size_t>(-2)), Error);
}

TEST(CpuBackend, RefusesMoreMemoryThanAllowedWithBothSizes) {
  const auto backend = make_cpu_backend({});
  const std::size_t allowed = backend->device().max_buffer_bytes;
  EXPECT_GT(allowed, 0U);
  EXPECT_THAT([&] { backend->allocate(allowed + 1); },
              ThrowsMessage<Error>(AllOf(HasSubstr(std::to_string(allowed + 1)), HasSubstr(std::to_string(allowed)))));
  EXPECT_THROW(backend->allocate(static_cast<std::size_t>(-1)), Error);
}

TEST(CpuBackend, SaysWhatItIs) {
  const auto backend = make_cpu_backend({.threads = 2, .isa = Isa::kBaseline});
  EXPECT_EQ(backend->device().kind, "cpu");
  EXPECT_EQ(backend->device().driver, "baseline");
  EXPECT_EQ(backend->device().threads, 2U);
  EXPECT_FALSE(backend->device().name.empty());
  EXPECT_EQ(backend->host_isa(), Isa::kBaseline);
  EXPECT_EQ(make_cpu_backend({})->host_isa(), best_isa());
}

TEST(CpuBackend, AnInstructionSetThatIsMissingIsRefused) {
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    if (isa_available(isa)) {
      EXPECT_EQ(make_cpu_backend({.threads = 1, .isa = isa})->device().driver, to_string(isa));
    } else {
      EXPECT_THROW(make_cpu_backend({.threads = 1, .isa = isa}), UnavailableError);
    }
  }
}

TEST(Buffer, MovesAndBecomesInvalidWithItsBackend) {
  auto backend = make_cpu_backend({});
  Buffer first = backend->allocate(8);
  const std::uint64_t id = first.id();
  Buffer second = std::move(first);
  EXPECT_FALSE(first.valid());  // NOLINT(bugprone-use-after-move): that is what is tested
  EXPECT_EQ(second.id(), id);
  EXPECT_THROW(static_cast<void>(backend->host_view(first)), Error);
  second = backend->allocate(4);
  EXPECT_EQ(backend->host_view(second).size(), 4U);
  EXPECT_TRUE(second.belongs_to(*backend));
  backend.reset();
  EXPECT_FALSE(second.valid());
  const auto other = make_cpu_backend({});
  EXPECT_THROW(static_cast<void>(other->host_view(second)), Error);
  const Buffer foreign = other->allocate(4);
  EXPECT_THROW(static_cast<void>(make_cpu_backend({})->host_view(foreign)), Error);
}

/// A small launch that is right, whose parts tests then spoil.
class Launch : public testing::Test {
 protected:
  std::unique_ptr<Backend> backend = make_cpu_backend({});
  Buffer seeds = backend->allocate(64 * 10);
  Buffer nearest = backend->allocate(4 * 64 * 10);
  JumpFloodInit::Params params{.width = 60, .height = 10, .stride = 64};
};

TEST_F(Launch, RightOnesRunAndAreCounted) {
  run<JumpFloodInit>(*backend, params, {60, 10, 1}, seeds, nearest);
  EXPECT_EQ(backend->dispatch_count(), 1U);
  EXPECT_EQ(backend->host_view(nearest)[4 * 59], std::byte{0xFF});
  EXPECT_EQ(backend->host_view(nearest)[4 * 60], std::byte{0});
}

TEST_F(Launch, CountsOfBuffersAndParametersAreChecked) {
  const std::array<const Buffer*, 1> one{&seeds};
  const std::array<const Buffer*, 2> two{&seeds, &nearest};
  const auto bytes = std::as_bytes(std::span(&params, 1));
  EXPECT_THAT(
      [&] {
        backend->dispatch(JumpFloodInit::info(), one, bytes, {60, 10, 1});
      },
      ThrowsMessage<Error>(HasSubstr("1 buffers given, 2 bound")));
  EXPECT_THAT(
      [&] {
        backend->dispatch(JumpFloodInit::info(), two, bytes.subspan(4), {60, 10, 1});
      },
      ThrowsMessage<Error>(HasSubstr("8 bytes of parameters given, 12 expected")));
}

TEST_F(Launch, ABufferThatIsWrittenMustNotBeBoundTwice) {
  EXPECT_THAT(
      [&] {
        run<JumpFloodInit>(*backend, params, {60, 10, 1}, seeds, seeds);
      },
      ThrowsMessage<Error>(HasSubstr("bound twice")));
}

TEST_F(Launch, ABufferThatOutlivedItsBackendIsRefused) {
  const auto other = make_cpu_backend({});
  EXPECT_THROW(run<JumpFloodInit>(*other, params, {60, 10, 1}, seeds, nearest), Error);
  EXPECT_THROW(run<JumpFloodInit>(*backend, params, {60, 10, 1}, seeds, Buffer{}), Error);
}

}  // namespace
}  // namespace gdtslam::test
