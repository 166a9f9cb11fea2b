// The same cloud, byte for byte, on the CPU and on a device.
#include <gtest/gtest.h>

#include "support/sweep_scans.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

TEST(SweepAssemblerOnDevice, GivesTheCloudOfTheCpu) {
  GDTSLAM_NEEDS_VULKAN();
  Random random(12);
  const NoddingScanner scanner = draw_scanner(random, 15);
  const std::vector<SweepScan> scans = draw_sweep_scans(random, scanner, 300);
  const auto cpu = make_cpu_backend({});
  for (const SweepForm form : {SweepForm::kWorking, SweepForm::kLiteral}) {
    const Cloud expected = assemble(scanner, {.form = form}, scans, *cpu);
    ASSERT_GT(expected.size(), 40000U);
    const auto device = test_backend();
    const AssemblyLimits limits{.form = form, .batch_beams = 8192};
    const Cloud found = assemble(scanner, limits, scans, *device);
    EXPECT_TRUE(found == expected);
    EXPECT_GT(device->dispatch_count(), 5U);
    EXPECT_EQ(device->pending_downloads(), 0U);
  }
}

}  // namespace
}  // namespace gdtslam::test
