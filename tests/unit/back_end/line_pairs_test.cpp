// Pairs of scans laid on each other on a device, against the host; a device that fails or has no room.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "engine/mapping/adjust/joint_adjustment.hpp"
#include "engine/mapping/adjust/line_pairs.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/queued_backend.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::QueuedBackend;

constexpr LineGate kPairGate{.most_m = 0.2, .points = 70};

class LinePairsTest : public testing::Test {
 protected:
  LinePairsTest() {
    const std::vector<Pose2> poses = test::drive_through_room();
    for (std::size_t i = 0; i < poses.size(); i += 5) {
      poses_.push_back(poses[i]);
      scans_.emplace_back(keep_scan(to_points(test::scan_of(test::furnished_room(), poses[i], 0.0, 181), {})));
    }
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      LinePair pair;
      pair.fixed = i - 1;
      pair.moving = i;
      pair.found_at = between(poses_[i - 1], poses_[i]) * Pose2{0.01, -0.02, 0.003};
      pair.at = pair.found_at * Pose2{0.004, 0.003, -0.001};
      pairs_.push_back(pair);
    }
  }
  BatchDevice on(QueuedBackend& device) {
    device_ = &device;
    return {.get = [this] { return device_; },
            .lost =
                [this](const DeviceError&) {
                  device_ = nullptr;
                  ++losses_;
                }};
  }
  std::vector<LinePair> built(const BatchDevice& device, std::span<const LineScan> moving) {
    std::vector<LinePair> pairs = pairs_;
    LinePairs(scans_, workers_, device).build(moving, kPairGate, pairs);
    return pairs;
  }
  static void expect_equal(const std::vector<LinePair>& a, const std::vector<LinePair>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_GT(a[i].equations.weight, 20.0);
      EXPECT_EQ(0, std::memcmp(&a[i].equations, &b[i].equations, sizeof(LineEquations))) << i;
    }
  }

  std::vector<Pose2> poses_;
  std::vector<LineScan> scans_;
  std::vector<LinePair> pairs_;
  WorkerPool workers_{2};
  Backend* device_ = nullptr;
  int losses_ = 0;
};

TEST_F(LinePairsTest, ADeviceBuildsThoseOfTheHostInOneSubmission) {
  QueuedBackend device;
  const std::vector<LineScan> elsewhere(scans_);
  const std::vector<LinePair> by_host = built({}, scans_);
  expect_equal(by_host, built(on(device), scans_));
  EXPECT_EQ(device.submit_count(), 1U);
  EXPECT_EQ(device.dispatch_count(), 1U);
  expect_equal(by_host, built(on(device), elsewhere));
  EXPECT_EQ(device.submit_count(), 2U);
}

TEST_F(LinePairsTest, ALargerBatchThanAnyBeforeHasRoomOnTheDevice) {
  const std::vector<LinePair> by_host = built({}, scans_);
  std::vector<LineScan> elsewhere(scans_);
  QueuedBackend device;
  LinePairs lines(scans_, workers_, on(device));
  for (const std::vector<LineScan>* moving : {&scans_, &elsewhere}) {
    std::vector<LinePair> pairs = pairs_;
    lines.build(*moving, kPairGate, pairs);
    expect_equal(by_host, pairs);
  }
  EXPECT_EQ(device.submit_count(), 2U);
}

TEST_F(LinePairsTest, WhateverCallOfTheDeviceFailsTheHostGoesOn) {
  const std::vector<LinePair> by_host = built({}, scans_);
  QueuedBackend whole;
  built(on(whole), scans_);
  for (std::uint64_t call = 1; call <= whole.calls().size(); ++call) {
    QueuedBackend device(call);
    losses_ = 0;
    expect_equal(by_host, built(on(device), scans_));
    EXPECT_EQ(losses_, 1) << call;
    EXPECT_EQ(device.calls_after_failure(), 0U);
  }
}

TEST_F(LinePairsTest, ADeviceWithoutRoomIsNotAsked) {
  const std::vector<LinePair> by_host = built({}, scans_);
  QueuedBackend device;
  device.set_max_buffer_bytes(std::size_t{1} << 12U);
  expect_equal(by_host, built(on(device), scans_));
  EXPECT_TRUE(device.calls().empty());
  EXPECT_EQ(losses_, 0);
}

TEST_F(LinePairsTest, AnAdjustmentOnADeviceGivesTheSamePoses) {
  std::vector<Pose2> by_host = poses_;
  for (std::size_t i = 1; i < by_host.size(); ++i) by_host[i] = by_host[i] * Pose2{0.02, -0.01, 0.01};
  std::vector<Pose2> by_device = by_host;
  const JointAdjustment adjustment(scans_, {}, {});
  adjustment.run(by_host, workers_);
  QueuedBackend device;
  adjustment.run(
      by_device, workers_, [](double) {}, on(device));
  EXPECT_GE(device.submit_count(), 1U);
  EXPECT_LE(device.submit_count(), 10U);
  for (std::size_t i = 0; i < by_host.size(); ++i) EXPECT_EQ(0, std::memcmp(&by_host[i], &by_device[i], sizeof(Pose2)));
}

}  // namespace
}  // namespace gdtslam
