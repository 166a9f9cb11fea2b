// A drive mapped on the device: the bits of the CPU, and the host's copy of the map equal to the device's own.
#include <gtest/gtest.h>

#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

TEST(VulkanMapper, GivesTheBitsOfTheCpuAndItsCopyIsTheDevicesField) {
  GDTSLAM_NEEDS_VULKAN();
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const std::vector<DriveScan> scans = room_scans(80, 2);
  MapperConfig config = quick_config(MatcherKind::kExhaustive);
  config.keyframe.every_scan = true;  // growth on the way
  for (const DistanceTransform transform : {DistanceTransform::kExact, DistanceTransform::kJumpFlood}) {
    config.map.transform = transform;
    const auto device = test_backend();
    expect_same(map_drive(scans, config, *device), map_drive(scans, config, *cpu));
    Mapper mapper(config, *device);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      mapper.process(scans[i].scan, scans[i].T_odom_base);
      if (i % 20 != 19) continue;
      const std::uint64_t before = device->submit_count();
      const std::vector<std::uint16_t> from_device = mapper.download_device_cells();
      ASSERT_GT(device->submit_count(), before) << "they did not come from the device";
      ASSERT_TRUE(from_device == mapper.field().download()) << i;
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
