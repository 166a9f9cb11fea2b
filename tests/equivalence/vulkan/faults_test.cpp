// Every call to the driver fails once, with every code: the error says which call and what it gave, nothing is
// submitted afterwards, and the backend goes away in peace.
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

class Faults : public testing::TestWithParam<VulkanFault::Code> {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

std::string result_of(VulkanFault::Code code) {
  switch (code) {
    case VulkanFault::Code::kOutOfDeviceMemory:
      return "ErrorOutOfDeviceMemory";
    case VulkanFault::Code::kOutOfHostMemory:
      return "ErrorOutOfHostMemory";
    case VulkanFault::Code::kDeviceLost:
      break;
  }
  return "ErrorDeviceLost";
}

/// No verb works any more, each says why, and nothing is submitted.
void expect_refusal(VulkanBackend& backend, const Buffer& buffer, const DeviceError& first) {
  const std::uint64_t submits = backend.submit_count();
  const std::uint64_t calls = backend.call_count();
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
  EXPECT_EQ(backend.call_count(), calls);
}

/// The job with the k-th call failing; whether there was such a call.
bool fails_at(std::uint64_t k, VulkanFault::Code code, const std::vector<std::byte>& expected) {
  VulkanOptions options;
  options.fault = {k, code};
  std::unique_ptr<VulkanBackend> backend;
  Buffer kept;
  try {
    backend = test_backend(options);
    kept = backend->allocate(kJobWidth * kJobHeight * 4);
    EXPECT_EQ(run_job(*backend, kRounds), expected) << "call " << k;
    return false;
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.call(), StartsWith("vk")) << "call " << k;
    EXPECT_THAT(error.result(), StartsWith(result_of(code))) << "call " << k;
    EXPECT_THAT(error.what(), HasSubstr(error.call())) << "call " << k;
    if (backend) {
      expect_refusal(*backend, kept, error);
    }
    return true;
  }
}

TEST_P(Faults, OfEveryCallAreReportedAndEndTheWork) {
  const auto cpu = make_cpu_backend({});
  const auto expected = run_job(*cpu, kRounds);
  std::uint64_t k = 1;
  while (fails_at(k, GetParam(), expected)) {
    ++k;
    ASSERT_FALSE(HasFailure());
    ASSERT_LT(k, 5000U);
  }
  RecordProperty("calls", static_cast<int>(k - 1));
  EXPECT_GT(k, 50U);  // creating all, pipelines, buffers, submissions
}

INSTANTIATE_TEST_SUITE_P(All, Faults,
                         testing::Values(VulkanFault::Code::kOutOfDeviceMemory, VulkanFault::Code::kOutOfHostMemory,
                                         VulkanFault::Code::kDeviceLost),
                         [](const auto& code) { return result_of(code.param); });

class Limits : public testing::Test {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

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
    unsetenv("GDTSLAM_VULKAN_FAULT");
    unsetenv("GDTSLAM_VULKAN_WAIT_S");
    unsetenv("GDTSLAM_VULKAN_SPIN_S");
  }
};

TEST_F(Environment, MayAskForAFault) {
  setenv("GDTSLAM_VULKAN_FAULT", "3:out-of-host-memory", 1);
  try {
    test_backend();
    FAIL() << "nothing failed";
  } catch (const DeviceError& error) {
    EXPECT_EQ(error.result(), "ErrorOutOfHostMemory");
  }
}

TEST_F(Environment, GivesWayToTheOptions) {
  setenv("GDTSLAM_VULKAN_FAULT", "1:device-lost", 1);
  VulkanOptions options;
  options.fault = {1000000, VulkanFault::Code::kDeviceLost};
  EXPECT_NO_THROW(run_job(*test_backend(options), 1));
}

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

TEST_F(Environment, WithNonsenseIsRefused) {
  for (const char* text : {"device-lost", "0:device-lost", "-1:device-lost", "5", "5:", "5:lost", "x:device-lost"}) {
    setenv("GDTSLAM_VULKAN_FAULT", text, 1);
    EXPECT_THROW(test_backend(), UsageError) << text;
  }
}

}  // namespace
}  // namespace gdtslam::test
