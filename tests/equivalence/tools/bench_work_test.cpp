// What `gdtslam-lab bench` counts and times on a device.
#include <gtest/gtest.h>

#include <memory>

#include "support/vulkan_device.hpp"
#include "tools/lab/bench/queue_work.hpp"

namespace gdtslam {
namespace {

TEST(BenchWork, AScanThatAsksTheDeviceForNothingHasNoTimeOfIt) {
  GDTSLAM_NEEDS_VULKAN();
  VulkanOptions options;
  options.time_submissions = true;
  const std::unique_ptr<VulkanBackend> device = test::test_backend(options);
  BenchLog log;
  log.file = GDTSLAM_SOURCE_DIR "/assets/logs/office-start.log.gz";
  log.mapper.match.matcher = MatcherKind::kExhaustive;
  log.mapper.scan.max_range_m = 3.0;
  log.mapper.scan.min_points = 150;  // most scans have fewer returns that near
  const WorkBench bench = run_work(log, *device);
  for (const ScanWork& scans : {bench.keyframes, bench.others}) {
    EXPECT_LE(scans.device_s.size(), scans.work.waits);
  }
  EXPECT_LT(bench.others.work.submissions, bench.others.scans / 2);
  if (device->vulkan_device().timestamp_ns > 0.0) {
    EXPECT_FALSE(bench.others.device_s.empty());
    EXPECT_FALSE(bench.keyframes.device_s.empty());
  }
}

}  // namespace
}  // namespace gdtslam
