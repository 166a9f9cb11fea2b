// A device that is lost at any step, or that takes too long: the error says what failed, nothing is submitted
// afterwards, and the backend goes away in peace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/core/error.hpp"
#include "small_job.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kRounds = 5;

/// No verb works any more, each says why, and nothing is submitted.
void expect_refusal(VulkanBackend& backend, const Buffer& buffer, const DeviceError& first) {
  const std::uint64_t submits = backend.submit_count();
  std::vector<std::byte> data(4);
  const auto refused = [&](auto verb) {
    try {
      verb();
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.call(), first.call());
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused([&] { backend.allocate(4); }));
  EXPECT_TRUE(refused([&] { backend.flush(); }));
  if (buffer.valid()) {
    EXPECT_TRUE(refused([&] { backend.upload(buffer, data); }));
    EXPECT_TRUE(refused([&] { backend.fill(buffer, 1); }));
    EXPECT_TRUE(refused([&] { backend.start_download(buffer, 4, 0); }));
    EXPECT_TRUE(refused([&] { backend.finish_download({1, 4}, data); }));
    EXPECT_TRUE(refused([&] { record_job(backend, buffer, 1); }));
  }
  EXPECT_EQ(backend.submit_count(), submits);
}

class Limits : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

TEST_F(Limits, ALossAtAnyStepIsReportedAndEndsTheWork) {
  const auto cpu = make_cpu_backend({});
  const auto expected = run_job(*cpu, kRounds);
  const auto is_lost = [&](std::uint64_t step) {
    const auto backend = test_backend({.lost_at = step});
    const Buffer kept = backend->allocate(kJobWidth * kJobHeight * 4);
    try {
      EXPECT_EQ(run_job(*backend, kRounds), expected) << "step " << step;
      return false;
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.result(), "ErrorDeviceLost") << "step " << step;
      EXPECT_THAT(error.what(), HasSubstr(error.call())) << "step " << step;
      expect_refusal(*backend, kept, error);
      return true;
    }
  };
  EXPECT_THROW(test_backend({.lost_at = 1}), DeviceError);
  std::uint64_t step = 3;
  while (is_lost(step)) {
    ++step;
    ASSERT_FALSE(HasFailure());
    ASSERT_LT(step, 5000U);
  }
  EXPECT_GT(step, 20U);  // buffers, launches, downloads
}

/// Some work of a tenth of a second at the very least; its result is asked for.
void wait_for_work(VulkanBackend& backend) {
  constexpr std::uint32_t kSide = 512;
  constexpr std::uint32_t kPoints = 4096;
  constexpr std::uint32_t kCandidates = 20000;
  const Buffer field = backend.allocate(kSide * kSide * 2);
  const Buffer points = backend.allocate(kPoints * sizeof(PointCells));
  const Buffer candidates = backend.allocate(kCandidates * sizeof(PoseCandidate));
  const Buffer cost = backend.allocate(kCandidates * 4);
  run<PoseCost>(backend, {.width = kSide, .height = kSide, .stride = kSide, .point_count = kPoints, .cap = 5120},
                {kCandidates, 1, 1}, field, points, candidates, cost);
  std::vector<std::byte> found(4);
  backend.download(cost, found);
}

TEST_F(Limits, AWaitThatTakesTooLongIsALostDevice) {
  VulkanOptions options;
  options.wait_limit_s = 1.0e-4;
  const auto backend = test_backend(options);
  const Buffer kept = backend->allocate(4);
  try {
    wait_for_work(*backend);
    FAIL() << "the wait ended in time";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.call(), "vkWaitSemaphores");
    EXPECT_THAT(error.result(), StartsWith("Timeout"));
    EXPECT_THAT(error.result(), AllOf(HasSubstr("1e-04 s"), HasSubstr("GDTSLAM_VULKAN_WAIT_S")));
    expect_refusal(*backend, kept, error);
  }
}

TEST_F(Limits, AskingBeforeSleepingIsAPartOfTheWait) {
  VulkanOptions options;
  options.wait_limit_s = 1.0e-4;
  options.spin_s = 60.0;
  EXPECT_THROW(wait_for_work(*test_backend(options)), DeviceError);
  options.wait_limit_s = 30.0;
  EXPECT_NO_THROW(wait_for_work(*test_backend(options)));
}

class Environment : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
  void TearDown() override {
    unsetenv("GDTSLAM_VULKAN_WAIT_S");
    unsetenv("GDTSLAM_VULKAN_SPIN_S");
  }
};

TEST_F(Environment, MaySetTheLimitOfAWait) {
  setenv("GDTSLAM_VULKAN_WAIT_S", "0.0001", 1);
  EXPECT_THROW(wait_for_work(*test_backend()), DeviceError);
  VulkanOptions options;
  options.wait_limit_s = 30.0;
  EXPECT_NO_THROW(wait_for_work(*test_backend(options))) << "the options go before it";
  setenv("GDTSLAM_VULKAN_WAIT_S", "60", 1);
  EXPECT_NO_THROW(wait_for_work(*test_backend()));
}

TEST_F(Environment, WithNonsenseForALimitIsRefused) {
  for (const char* text : {"0", "-1", "soon", "30 s", "inf", "nan", "1e999", "1e300", "86401", " 5"}) {
    setenv("GDTSLAM_VULKAN_WAIT_S", text, 1);
    EXPECT_THROW(test_backend(), UsageError) << text;
  }
}

TEST_F(Environment, WithNonsenseForASpinIsRefused) {
  for (const char* text : {"-1", "soon", "5 us", "inf", "nan", "86401", " 5"}) {
    setenv("GDTSLAM_VULKAN_SPIN_S", text, 1);
    VulkanOptions options;
    options.index = find_test_device().device.value().index;
    EXPECT_THROW(make_vulkan_backend(options), UsageError) << text;
  }
}

}  // namespace
}  // namespace gdtslam::test
