// The map on a device that shares no memory: the host's copy is the device's field, bit for bit, and the number of
// submissions is the one that the design promises: one a scan, two a window, one a keyframe.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/queued_backend.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::QueuedBackend;

/// The cells where they lie on the host against those that came from the device.
void expect_equal_copies(const Mapper& mapper, const std::vector<std::uint16_t>& from_device) {
  const GlobalField& copy = mapper.field();
  EXPECT_TRUE(from_device == copy.download());
}

class DeviceMapTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto walls = test::furnished_room();
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      scans_.push_back(test::scan_of(walls, truth_[i], static_cast<double>(i)));
    }
  }

  std::vector<Pose2> truth_ = test::drive_through_room();
  std::vector<LaserScan> scans_;
  MapperConfig config_;
  QueuedBackend device_;
};

TEST_F(DeviceMapTest, OneSubmissionAScanTwoAWindowAndOneAKeyframe) {
  config_.match.matcher = MatcherKind::kExhaustive;
  Mapper mapper(config_, device_);
  std::uint64_t keyframes = 0;
  std::uint64_t attempts = 0;
  // Half way the robot is turned by 80 degrees while no odometry tells, so that some scans need more than one window.
  constexpr std::size_t kTurned = 75;
  scans_.erase(scans_.begin() + kTurned, scans_.begin() + kTurned + 20);
  truth_.erase(truth_.begin() + kTurned, truth_.begin() + kTurned + 20);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const std::uint64_t before = device_.submit_count();
    const MatchResult result = mapper.process(scans_[i], i == kTurned ? std::nullopt : std::optional(truth_[i]));
    // The descent from the prediction; the samples of a window and the descents from the best of them; the merge.
    const std::uint64_t matching = i > 0 ? 1 + 2 * result.attempts : 0;
    EXPECT_EQ(device_.submit_count() - before, matching + (result.merged ? 1U : 0U)) << i;
    EXPECT_EQ(result.attempts > 0, i > 0);
    attempts += result.attempts;
    keyframes += result.merged ? 1 : 0;
  }
  const MapperStatistics& statistics = mapper.statistics();
  EXPECT_GT(attempts, truth_.size() - 1) << "no scan needed a second window";
  EXPECT_EQ(statistics.attempts, attempts);
  EXPECT_EQ(statistics.keyframes, keyframes);
  const std::uint64_t descents = truth_.size() - 1 + attempts;
  EXPECT_EQ(statistics.submissions, descents + attempts + keyframes);
  EXPECT_EQ(statistics.dispatches, device_.dispatch_count());
  const auto& calls = device_.calls();
  const auto count = [&](std::string_view call) {
    return static_cast<std::uint64_t>(std::count(calls.begin(), calls.end(), call));
  };
  EXPECT_EQ(count("pose_descent"), descents);
  EXPECT_EQ(count("pose_cost"), attempts);
  EXPECT_EQ(count("finish_download"), 2 * descents + attempts)
      << "nothing but the ends of descents, the values under the points there and the costs of samples comes back";
  EXPECT_EQ(count("upload"), 2 * (descents + attempts) + keyframes + 1)
      << "points and poses of each dispatch, a keyframe's cells, and the table of distances";
}

TEST_F(DeviceMapTest, TheCopyIsTheDevicesFieldAtAnyTime) {
  config_.match.matcher = MatcherKind::kExhaustive;  // those that walk on the host have no field on the device
  Mapper mapper(config_, device_);
  EXPECT_TRUE(mapper.download_device_cells().empty());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    if (!mapper.process(scans_[i], truth_[i]).merged) continue;
    const std::uint64_t before = device_.submit_count();
    const std::vector<std::uint16_t> from_device = mapper.download_device_cells();
    ASSERT_GT(device_.submit_count(), before) << "they did not come from the device";
    expect_equal_copies(mapper, from_device);
    ASSERT_FALSE(HasFailure()) << i;
    ++compared;
  }
  EXPECT_GT(compared, 5U);
}

}  // namespace
}  // namespace gdtslam
