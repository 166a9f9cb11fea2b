// A device that fails at the k-th call, for every k of a drive: the poses and the map are those of the CPU, one warning
// is given, and the device is asked for nothing more. The drive on the CPU is the reference.
#include <algorithm>

#include <gtest/gtest.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/queued_backend.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::QueuedBackend;

// The map without what lies between its rows.
std::vector<std::uint16_t> cells_of(const GlobalField& field) {
  const GridGeometry grid = field.geometry();
  const auto all = field.cells();
  std::vector<std::uint16_t> cells;
  for (std::size_t y = 0; y < static_cast<std::size_t>(grid.height); ++y) {
    const auto row = all.subspan(y * field.stride(), static_cast<std::size_t>(grid.width));
    cells.insert(cells.end(), row.begin(), row.end());
  }
  return cells;
}

class DeviceLoss : public testing::TestWithParam<MatcherKind> {
 protected:
  struct Drive {
    std::vector<Pose2> poses;
    std::vector<std::uint16_t> cells;
    GridGeometry geometry;
    MapperStatistics statistics;
    std::vector<std::string> warnings;
    bool lost = false;
  };

  void SetUp() override {
    config_.match.matcher = GetParam();
    config_.scan.max_range_m = 3.0;  // sees a part of the room, so that the map grows
    config_.map.resolution_m = 0.03;
    config_.merge.threshold_m = 0.03;
    config_.search.step_m = 0.3;  // the drive is made some thousand times
    config_.search.step_rad = 0.07;
    config_.search.max_half_m = 0.6;
  }

  // The first scans of the drive, each `step`-th.
  void choose_scans(std::size_t count, std::size_t step) {
    const auto walls = test::furnished_room();
    const auto all = test::drive_through_room();
    for (std::size_t i = 0; i < count; ++i) {
      truth_.push_back(all.at(i * step));
      scans_.push_back(test::scan_of(walls, truth_.back(), static_cast<double>(i)));
    }
  }

  Drive drive(Backend& backend) const {
    Drive done;
    Mapper mapper(config_, backend, {.fall_back = true, .cpu = {}, .warn = [&done](const std::string& text) {
                                       done.warnings.push_back(text);
                                     }});
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      done.poses.push_back(mapper.process(scans_[i], truth_[i]).T_map_base);
    }
    done.cells = cells_of(mapper.field());
    done.geometry = mapper.field().geometry();
    done.statistics = mapper.statistics();
    done.lost = mapper.lost_device();
    EXPECT_EQ(mapper.device_loss().empty(), done.warnings.empty());
    return done;
  }

  static void expect_same(const Drive& found, const Drive& expected) {
    EXPECT_TRUE(found.poses == expected.poses);
    EXPECT_EQ(found.geometry, expected.geometry);
    EXPECT_TRUE(found.cells == expected.cells);
    EXPECT_EQ(found.statistics.keyframes, expected.statistics.keyframes);
    EXPECT_EQ(found.statistics.matched, expected.statistics.matched);
    EXPECT_EQ(found.statistics.attempts, expected.statistics.attempts);
    EXPECT_EQ(found.statistics.evaluations, expected.statistics.evaluations);
    EXPECT_EQ(found.statistics.scans, expected.statistics.scans);
  }

  void expect_recovery_from(std::uint64_t call, const Drive& expected) const {
    QueuedBackend device(call);
    const Drive found = drive(device);
    expect_same(found, expected);
    EXPECT_TRUE(found.lost);
    EXPECT_EQ(found.warnings.size(), 1U);
    EXPECT_EQ(device.calls().size(), call);
    EXPECT_EQ(device.calls_after_failure(), 0U);
    if (!found.warnings.empty()) {
      EXPECT_NE(found.warnings[0].find(device.calls().back() + " gave ErrorDeviceLost"), std::string::npos)
          << found.warnings[0];
    }
  }

  MapperConfig config_;
  std::vector<Pose2> truth_;
  std::vector<LaserScan> scans_;
};

TEST_P(DeviceLoss, EveryCallOfADriveMayFail) {
  choose_scans(24, 4);
  const auto cpu = make_cpu_backend({});
  const Drive expected = drive(*cpu);
  QueuedBackend device;
  const Drive whole = drive(device);
  expect_same(whole, expected);
  EXPECT_FALSE(whole.lost);
  const auto& calls = device.calls();
  ASSERT_GT(std::count(calls.begin(), calls.end(), "gdt_merge"), 10) << "too few keyframes for a test";
  ASSERT_GT(std::count(calls.begin(), calls.end(), "field_grow"), 0) << "the map never grew";
  for (std::uint64_t call = 1; call <= calls.size(); ++call) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + calls[call - 1]);
    expect_recovery_from(call, expected);
    if (HasFailure()) return;
  }
}

TEST_P(DeviceLoss, WhileTheJournalIsBeingCutShort) {
  config_.keyframe.every_scan = true;
  choose_scans(160, 1);
  const auto cpu = make_cpu_backend({});
  const Drive expected = drive(*cpu);
  QueuedBackend device;
  expect_same(drive(device), expected);
  // The host matcher replays each keyframe at once and needs no checkpoint; the other's begins with a copy of the
  // field.
  const auto& calls = device.calls();
  std::vector<std::uint64_t> checkpoints;
  for (std::size_t i = 1; i < calls.size(); ++i) {
    if (calls[i] == "start_download" && calls[i - 1] == "field_grow") checkpoints.push_back(i + 1);
  }
  ASSERT_EQ(checkpoints.size(), GetParam() == MatcherKind::kExhaustive ? 2U : 0U);
  for (const std::uint64_t checkpoint : checkpoints) {
    for (std::uint64_t call = checkpoint - 3; call < checkpoint + 25; ++call) {
      SCOPED_TRACE("call " + std::to_string(call) + ", " + calls[call - 1]);
      expect_recovery_from(call, expected);
      if (HasFailure()) return;
    }
  }
}

TEST_P(DeviceLoss, WithoutLeaveToFallBackTheErrorComesAndTheMapIsWhole) {
  choose_scans(24, 4);
  // The map after each keyframe, from the CPU.
  const auto cpu = make_cpu_backend({});
  Mapper reference(config_, *cpu);
  std::vector<std::vector<std::uint16_t>> maps{{}};
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    if (reference.process(scans_[i], truth_[i]).merged) maps.push_back(cells_of(reference.field()));
  }
  QueuedBackend whole;
  drive(whole);
  std::size_t failures_after_construction = 0;
  for (std::uint64_t call = 1; call <= whole.calls().size(); call += 3) {
    SCOPED_TRACE("call " + std::to_string(call) + ", " + whole.calls()[call - 1]);
    QueuedBackend device(call);
    std::unique_ptr<Mapper> mapper;
    try {
      mapper = std::make_unique<Mapper>(config_, device, MapperOptions{.fall_back = false, .cpu = {}, .warn = {}});
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.result(), "ErrorDeviceLost");
      continue;
    }
    ++failures_after_construction;
    std::size_t scan = 0;
    EXPECT_THROW(for (; scan < scans_.size(); ++scan) mapper->process(scans_[scan], truth_[scan]), DeviceError);
    ASSERT_LT(scan, scans_.size());
    EXPECT_TRUE(mapper->lost_device());
    EXPECT_THROW(mapper->process(scans_[scan], truth_[scan]), DeviceError);
    EXPECT_EQ(device.calls_after_failure(), 0U);
    EXPECT_EQ(cells_of(mapper->field()), maps.at(mapper->statistics().keyframes));
    if (HasFailure()) return;
  }
  EXPECT_GT(failures_after_construction, 50U);
}

TEST_P(DeviceLoss, AMapBeyondTheLargestBufferGoesOnOnTheCpu) {
  choose_scans(24, 4);
  const auto cpu = make_cpu_backend({});
  const Drive expected = drive(*cpu);
  QueuedBackend device;
  device.set_max_buffer_bytes(std::size_t{2} * static_cast<std::size_t>(expected.geometry.width) *
                              static_cast<std::size_t>(expected.geometry.height));  // its rows need some more
  const Drive found = drive(device);
  expect_same(found, expected);
  EXPECT_TRUE(found.lost);
}

INSTANTIATE_TEST_SUITE_P(Matchers, DeviceLoss, testing::Values(MatcherKind::kSimplex, MatcherKind::kExhaustive),
                         [](const auto& kind) {
                           return kind.param == MatcherKind::kSimplex ? "simplex" : "exhaustive";
                         });

}  // namespace
}  // namespace gdtslam
