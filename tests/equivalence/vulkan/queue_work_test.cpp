// What a device counts of its own work: against sequences counted by hand, against the calls that a stand-in for a
// device saw of the same drive, and against what the matcher's chain asks for in theory.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "small_job.hpp"
#include "support/mapper_drive.hpp"
#include "support/queued_backend.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class QueueWorkOfADevice : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

TEST_F(QueueWorkOfADevice, IsWhatWasAskedFor) {
  const auto device = test_backend();
  const QueueWork before = device->work();
  const Buffer whole = device->allocate(400);
  const Buffer part = device->allocate(400);
  device->upload(whole, std::vector<std::byte>(400));      // nothing of its zeros is seen
  device->upload(part, std::vector<std::byte>(100), 200);  // zeros first, and after them
  device->fill(part, 7);
  EXPECT_EQ(device->work().submissions, before.submissions);
  std::vector<std::byte> found(120);
  device->download(whole, found, 40);
  const QueueWork first = device->work() - before;
  EXPECT_EQ(first.dispatch_sum(), 0U);
  EXPECT_EQ(first.uploads, 2U);
  EXPECT_EQ(first.upload_bytes, 500U);
  EXPECT_EQ(first.fills, 2U);
  EXPECT_EQ(first.downloads, 1U);
  EXPECT_EQ(first.download_bytes, 120U);
  EXPECT_EQ(first.submissions, 1U);
  EXPECT_EQ(first.waits, 1U);
  EXPECT_EQ(first.barriers, 2U);  // between zeros, upload and fill of one buffer; the last one serves the copy down

  record_job(*device, new_map(*device), 1);
  const QueueWork job = device->work() - before - first;
  const std::map<std::string_view, std::uint64_t> kernels{
      {"jump_flood_init", 1}, {"jump_flood_distance", 1}, {"distance_field", 1}, {"gdt_merge", 1}};
  EXPECT_EQ(job.dispatches, kernels);
  EXPECT_EQ(job.submissions + job.waits, 0U);
}

// Uploads, downloads and each kernel, as many as the interface was asked for.
TEST_F(QueueWorkOfADevice, IsThatOfTheSameDriveOnAStandIn) {
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.keyframe.every_scan = true;  // growth
  const std::vector<DriveScan> scans = room_scans(80, 2);
  QueuedBackend stand_in;
  const MappedDrive expected = map_drive(scans, config, stand_in);
  const auto device = test_backend();
  expect_same(map_drive(scans, config, *device), expected);

  std::map<std::string_view, std::uint64_t> kernels;
  std::map<std::string_view, std::uint64_t> verbs;
  for (const std::string& call : stand_in.calls()) {
    ++(find_kernel(call) != nullptr ? kernels : verbs)[call];
  }
  const QueueWork work = device->work();
  EXPECT_EQ(work.dispatches, kernels);
  EXPECT_EQ(work.dispatch_sum(), stand_in.dispatch_count());
  EXPECT_EQ(work.uploads, verbs["upload"]);
  EXPECT_EQ(work.downloads, verbs["start_download"]);
  EXPECT_EQ(work.submissions, device->submit_count());
}

// The chain of docs/howto/gpu.md: a scan that is searched for in one window and not merged. Three dispatches, each a
// submission that the host waits for: the descent from the prediction, the samples of the window, and the descents from
// the best of them.
TEST_F(QueueWorkOfADevice, OfAScanIsThatOfTheChain) {
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.search.attempts = 1;
  config.keyframe.distance_m = 100.0;
  config.keyframe.angle_rad = 3.0;
  constexpr std::uint64_t kSamples = 5U * 5U * 7U;
  const std::vector<DriveScan> scans = room_scans(12, 2);
  const auto device = test_backend();
  Mapper mapper(config, *device);
  std::size_t settled = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const QueueWork before = device->work();
    const MatchResult result = mapper.process(scans[i].scan, scans[i].T_odom_base);
    if (i == 0) continue;  // it is the map
    ASSERT_FALSE(result.merged);
    const QueueWork work = device->work() - before;
    const std::map<std::string_view, std::uint64_t> chain{{"pose_descent", 2}, {"pose_cost", 1}};
    EXPECT_EQ(work.dispatches, chain);
    EXPECT_EQ(work.submissions, 3U);
    EXPECT_EQ(work.waits, 3U);
    EXPECT_EQ(work.uploads, 6U);    // points and poses of each dispatch
    EXPECT_EQ(work.downloads, 5U);  // costs; ends of descents and the values there, twice
    const std::uint64_t others = 3 * 8U * result.points + 32 + 16 * kSamples;
    ASSERT_GT(work.upload_bytes, others);
    const std::uint64_t starts = (work.upload_bytes - others) / 32;
    EXPECT_EQ(work.upload_bytes, others + 32 * starts);
    EXPECT_LE(starts, static_cast<std::uint64_t>(config.search.starts));
    const std::uint64_t row = 2 * PoseDescent::row_of(result.points);
    EXPECT_EQ(work.download_bytes, (1 + starts) * (32 + row) + 4 * kSamples);
    // Before and after each dispatch, and before the first poses take the place of those that were copied down.
    if (work.fills != 0) continue;  // larger buffers
    EXPECT_EQ(work.barriers, 7U);
    ++settled;
  }
  EXPECT_GE(settled, 6U);
}

TEST_F(QueueWorkOfADevice, WaitsThatAskFirstChangeNothing) {
  const MapperConfig config = quick_config(MatcherKind::kExhaustive);
  const std::vector<DriveScan> scans = room_scans(20, 2);
  const auto sleeping = test_backend({.spin_s = 0.0});
  const MappedDrive expected = map_drive(scans, config, *sleeping);
  for (const double spin_s : {1.0e-6, 1.0}) {
    const auto device = test_backend({.spin_s = spin_s});
    expect_same(map_drive(scans, config, *device), expected);
    EXPECT_EQ(device->work().waits, sleeping->work().waits);
    EXPECT_EQ(device->work().dispatches, sleeping->work().dispatches);
    EXPECT_EQ(device->submit_count(), sleeping->submit_count());
  }
}

}  // namespace
}  // namespace gdtslam::test
