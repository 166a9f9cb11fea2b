// A drive mapped on the device: the bits of the CPU, as many submissions as the design promises, and the host's copy of
// the map equal to the device's own. A matcher that walks on the host submits nothing.
#include <gtest/gtest.h>

#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class VulkanMapper : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
  void expect_the_bits_of_the_cpu();

  MapperConfig config_ = quick_config(MatcherKind::kExhaustive);
  std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
};

TEST_F(VulkanMapper, GivesTheBitsOfTheCpuAndItsCopyIsTheDevicesField) {
  for (const DistanceTransform transform : {DistanceTransform::kExact, DistanceTransform::kJumpFlood}) {
    config_.map.transform = transform;
    expect_the_bits_of_the_cpu();
  }
}

void VulkanMapper::expect_the_bits_of_the_cpu() {
  config_.keyframe.every_scan = true;  // growth on the way
  const std::vector<DriveScan> scans = room_scans(80, 2);
  const MappedDrive expected = map_drive(scans, config_, *cpu_);
  const auto device = test_backend();
  expect_same(map_drive(scans, config_, *device), expected);

  Mapper mapper(config_, *device);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    mapper.process(scans[i].scan, scans[i].T_odom_base);
    if (i % 20 != 19) continue;
    const std::uint64_t before = device->submit_count();
    const std::vector<std::uint16_t> from_device = mapper.download_device_cells();
    ASSERT_GT(device->submit_count(), before) << "they did not come from the device";
    const GlobalField& copy = mapper.field();
    ASSERT_TRUE(from_device == copy.download()) << i;
  }
}

TEST_F(VulkanMapper, SubmitsNothingForAMatcherThatWalksOnTheHost) {
  config_.match.matcher = MatcherKind::kSimplex;
  const std::vector<DriveScan> scans = room_scans(80, 2);
  const auto device = test_backend();
  const MappedDrive found = map_drive(scans, config_, *device);
  expect_same(found, map_drive(scans, config_, *cpu_));
  EXPECT_EQ(found.statistics.scans, scans.size());
  EXPECT_EQ(found.loss, "");
  EXPECT_EQ(device->submit_count(), 0U);
  EXPECT_EQ(device->dispatch_count(), 0U);
}

TEST(VulkanMapperSubmits, OnceForAWindowAndOnceForAKeyframe) {
  GDTSLAM_NEEDS_VULKAN();
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.keyframe.every_scan = true;
  const std::vector<DriveScan> scans = room_scans(80, 2);
  const auto device = test_backend();
  Mapper mapper(config, *device);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::uint64_t before = device->submit_count();
    const MatchResult result = mapper.process(scans[i].scan, scans[i].T_odom_base);
    EXPECT_EQ(device->submit_count() - before, result.attempts + (result.merged ? 1U : 0U)) << i;
  }
  const MapperStatistics& statistics = mapper.statistics();
  EXPECT_GT(statistics.keyframes, 64U);
  EXPECT_GE(statistics.attempts, statistics.matched - 1);
  EXPECT_EQ(statistics.submissions, statistics.attempts + statistics.keyframes);
  EXPECT_EQ(device->submit_count(), statistics.submissions);
}

}  // namespace
}  // namespace gdtslam::test
