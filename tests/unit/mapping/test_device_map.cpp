// The map on a device that shares no memory: the host's copy is the device's field, bit for bit, and the number of
// submissions is the one that the design promises: one a window, one a keyframe.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"
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

TEST_F(DeviceMapTest, OneSubmissionAWindowAndOneAKeyframe) {
  config_.match.matcher = MatcherKind::kExhaustive;
  Mapper mapper(config_, device_);
  std::uint64_t keyframes = 0;
  std::uint64_t attempts = 0;
  // Half way the robot is turned by 56 degrees while no odometry tells, so that some scans need more than one window.
  constexpr std::size_t kTurned = 75;
  scans_.erase(scans_.begin() + kTurned, scans_.begin() + kTurned + 14);
  truth_.erase(truth_.begin() + kTurned, truth_.begin() + kTurned + 14);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const bool first = i == 0;
    const std::uint64_t before = device_.submit_count();
    mapper.start(scans_[i], i == kTurned ? std::nullopt : std::optional(truth_[i]));
    EXPECT_EQ(device_.submit_count() - before, first ? 0U : 1U) << "the device must be at work when start() returns";
    const MatchResult result = mapper.finish();
    EXPECT_EQ(device_.submit_count() - before, result.attempts + (result.merged ? 1U : 0U)) << i;
    EXPECT_EQ(result.attempts > 0, !first);
    attempts += result.attempts;
    keyframes += result.merged ? 1 : 0;
  }
  const MapperStatistics& statistics = mapper.statistics();
  EXPECT_GT(attempts, truth_.size() - 1) << "no scan needed a second window";
  EXPECT_EQ(statistics.attempts, attempts);
  EXPECT_EQ(statistics.keyframes, keyframes);
  EXPECT_EQ(statistics.submissions, attempts + keyframes);
  EXPECT_EQ(statistics.dispatches, device_.dispatch_count());
  const auto& calls = device_.calls();
  EXPECT_EQ(std::count(calls.begin(), calls.end(), "finish_download"), static_cast<std::ptrdiff_t>(attempts))
      << "nothing but verdicts comes back";
  EXPECT_EQ(std::count(calls.begin(), calls.end(), "upload"),
            static_cast<std::ptrdiff_t>(truth_.size() - 1 + keyframes + 1))
      << "a scan's points, a keyframe's cells, and the table of distances, each once";
}

TEST_F(DeviceMapTest, AJournalCutShortCostsNoSubmission) {
  config_.match.matcher = MatcherKind::kExhaustive;
  config_.keyframe.every_scan = true;
  config_.map.resolution_m = 0.01;  // so that the map comes in several pieces
  config_.merge.threshold_m = 0.01;
  Mapper mapper(config_, device_);
  for (std::size_t i = 0; i < truth_.size(); ++i) mapper.process(scans_[i], truth_[i]);
  const MapperStatistics statistics = mapper.statistics();  // before the test itself downloads
  const std::size_t bytes = 2 * mapper.download_device_cells().size();
  const std::size_t pieces = (bytes + (1U << 20U) - 1) >> 20U;
  EXPECT_GE(pieces, 2U);
  EXPECT_LE(pieces, 8U);
  EXPECT_EQ(statistics.keyframes, truth_.size());
  EXPECT_EQ(statistics.submissions, statistics.attempts + statistics.keyframes);
  const auto& calls = device_.calls();
  EXPECT_GE(std::count(calls.begin(), calls.end(), "finish_download"),
            static_cast<std::ptrdiff_t>(statistics.attempts + 2 * 2))
      << "two fields in pieces, and a verdict for each window";
  // What was downloaded and what was replayed on top of it.
  expect_equal_copies(mapper, mapper.download_device_cells());
}

// Keyframes wait for the host until a copy of the field has come, a piece with each keyframe, and holds them.
TEST_F(DeviceMapTest, TheJournalIsCutShort) {
  config_.map.resolution_m = 0.01;
  config_.merge.threshold_m = 0.01;
  const auto cpu = make_cpu_backend({});
  KeyframeMap host(config_, *cpu);
  DeviceMap map(config_, device_, host);
  StageTimes stages;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const auto points = in_map(points_of(scans_[i], config_.scan), truth_[i]);
    const KeyframeCells keyframe = keyframe_of(points, config_.map.resolution_m, config_.map.radius_cells());
    host.field.grow_to_hold(keyframe.window);
    map.note(keyframe);
    longest = std::max(longest, map.journal_length());
    map.merge(stages);
    map.take_checkpoint_piece();
  }
  const std::size_t pieces =
      (2 * map.field().snapshot_stride() * static_cast<std::size_t>(map.field().box().height()) + (1U << 20U) - 1) >>
      20U;
  EXPECT_GE(pieces, 2U);
  EXPECT_LE(pieces, 8U);
  EXPECT_GE(longest, 64U);
  EXPECT_LE(longest, 64U + pieces);
  map.update_host();
  EXPECT_EQ(map.journal_length(), 0U);
  EXPECT_EQ(map.field().download(), host.field.download());
}

/// A map on a device and its copy on the CPU, for keyframes of a few points.
struct CopiedMap {
  CopiedMap(const MapperConfig& c, Backend& device) : config(c), host(config, *cpu), map(config, device, host) {}
  void merge(const std::vector<Point2>& points) {
    const KeyframeCells keyframe = keyframe_of(points, config.map.resolution_m, config.map.radius_cells());
    host.field.grow_to_hold(keyframe.window);
    map.note(keyframe);
    map.merge(stages);
  }
  void expect_same_cells() const {
    const std::vector<std::uint16_t> cells = map.field().download();
    const CellBox& box = map.field().box();
    std::vector<std::uint16_t> row(static_cast<std::size_t>(box.width()));
    auto expected = cells.begin();
    for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
      host.field.read_row({box.min.x, y}, row);
      ASSERT_TRUE(std::equal(row.begin(), row.end(), expected)) << y;
      expected += box.width();
    }
  }
  MapperConfig config;
  std::unique_ptr<Backend> cpu = make_cpu_backend({});
  KeyframeMap host;
  DeviceMap map;
  StageTimes stages;
};

// The map goes on without it, and so must the CPU's, which counts tiles and would have room for it.
TEST_F(DeviceMapTest, AKeyframeThatTheDeviceHasNoRoomForReachesNoMap) {
  config_.map.max_megacells = 1;
  CopiedMap copied(config_, device_);
  copied.merge({{0.0, 0.0}, {1.0, 0.5}});
  EXPECT_THROW(copied.merge({{100.0, 100.0}}), InputError);
  EXPECT_EQ(copied.map.journal_length(), 1U);
  copied.merge({{1.0, -2.0}});
  copied.map.update_host();
  copied.expect_same_cells();
  EXPECT_EQ(copied.host.field.at(map_cell_of({100.0, 100.0}, config_.map.resolution_m)), copied.host.field.cap());
}

// A corridor along the border of tiles: as a rectangle it has room, as whole tiles it has not.
TEST_F(DeviceMapTest, TheCopyHasRoomForWhatTheDeviceHas) {
  config_.map.max_megacells = 1;
  CopiedMap copied(config_, device_);
  const double cell_m = config_.map.resolution_m;
  for (int k = 0; k < 12; ++k) {
    std::vector<Point2> wall;
    for (int i = 0; i < 50; ++i) wall.emplace_back((1000 * k + 20 * i + 0.5) * cell_m, 0.5 * cell_m);
    copied.merge(wall);
  }
  copied.map.update_host();
  EXPECT_GT(copied.host.field.taken_cells(), std::uint64_t{1} << 20U);
  copied.expect_same_cells();
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
