// A download that nobody can ask for any more is forgotten: the handle is dropped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "support/queued_backend.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

struct Maker {
  const char* name;
  std::function<std::unique_ptr<Backend>()> make;
  bool needs_vulkan = false;
};

class ForgottenDownloads : public testing::TestWithParam<Maker> {
 protected:
  void SetUp() override {
    if (GetParam().needs_vulkan) GDTSLAM_NEEDS_VULKAN();
    backend = GetParam().make();
  }
  std::unique_ptr<Backend> backend;
};

TEST_P(ForgottenDownloads, GoWithTheirHandles) {
  constexpr std::size_t kBytes = 4096;
  const Buffer buffer = backend->allocate(kBytes);
  backend->fill(buffer, 0x05050505U);
  for (int round = 0; round < 50; ++round) {
    const PendingDownload dropped = backend->start_download(buffer, kBytes);
    EXPECT_EQ(backend->pending_downloads(), 1U) << "round " << round;
    if (round % 3 == 0) backend->flush();
  }
  EXPECT_EQ(backend->pending_downloads(), 0U);
  std::vector<std::byte> found(kBytes);
  backend->download(buffer, found);
  EXPECT_EQ(std::count(found.begin(), found.end(), std::byte{5}), static_cast<std::ptrdiff_t>(kBytes));
  EXPECT_EQ(backend->pending_downloads(), 0U);
}

TEST_P(ForgottenDownloads, StayWhileThereIsACopyOfTheHandle) {
  const Buffer buffer = backend->allocate(8);
  backend->fill(buffer, 0x07070707U);
  PendingDownload copy;
  {
    const PendingDownload first = backend->start_download(buffer, 8);
    copy = first;
  }
  EXPECT_EQ(backend->pending_downloads(), 1U);
  std::vector<std::byte> found(8);
  backend->finish_download(copy, found);
  EXPECT_EQ(found, std::vector<std::byte>(8, std::byte{7}));
  EXPECT_EQ(backend->pending_downloads(), 0U);
  EXPECT_NO_THROW(copy = {});
}

TEST_P(ForgottenDownloads, MayOutliveTheirBackend) {
  std::optional<PendingDownload> pending;
  {
    const Buffer buffer = backend->allocate(8);
    pending = backend->start_download(buffer, 8);
  }
  backend.reset();
  EXPECT_NO_THROW(pending.reset());
}

INSTANTIATE_TEST_SUITE_P(
    On, ForgottenDownloads,
    testing::Values(Maker{"cpu", [] { return make_cpu_backend({}); }},
                    Maker{"queued", [] { return std::unique_ptr<Backend>(std::make_unique<QueuedBackend>()); }},
                    Maker{"vulkan", [] { return std::unique_ptr<Backend>(test_backend()); }, true}),
    [](const auto& maker) { return std::string(maker.param.name); });

/// Pieces of the ring of several submissions, all of them under way at once, and forgotten before the device has them.
TEST(ForgottenDownloadsOfVulkan, LeaveThoseBesideThemAsTheyAre) {
  GDTSLAM_NEEDS_VULKAN();
  const auto backend = test_backend();
  constexpr std::size_t kBytes = std::size_t{6} << 20U;  // more than a segment
  const Buffer buffer = backend->allocate(kBytes);
  backend->fill(buffer, 0x01010101U);
  std::optional<PendingDownload> dropped = backend->start_download(buffer, kBytes);
  backend->fill(buffer, 0x02020202U);
  const PendingDownload kept = backend->start_download(buffer, kBytes);
  EXPECT_EQ(backend->pending_downloads(), 2U);
  dropped.reset();
  EXPECT_EQ(backend->pending_downloads(), 1U);
  std::vector<std::byte> found(kBytes);
  backend->finish_download(kept, found);
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](std::byte b) { return b == std::byte{2}; }));
  EXPECT_EQ(backend->pending_downloads(), 0U);
}

TEST(ForgottenDownloadsOfVulkan, AreForgottenAlsoWhenTheDeviceIsLost) {
  GDTSLAM_NEEDS_VULKAN();
  const auto backend = test_backend({.lost_at = 4});  // the flush
  const Buffer buffer = backend->allocate(8);
  {
    const PendingDownload pending = backend->start_download(buffer, 8);
    EXPECT_THROW(backend->flush(), DeviceError);
    EXPECT_EQ(backend->pending_downloads(), 1U);
  }
  EXPECT_EQ(backend->pending_downloads(), 0U);
}

}  // namespace
}  // namespace gdtslam::test
