// Scans that nobody sees points of, placed between fixes, before the first, behind the last and blind for long: by
// hand, at and beside each limit.
#include "engine/mapping/nodding/scan_placer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/mapping/global_field.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

class PlacedByHand : public testing::Test {
 protected:
  PlacedByHand() {
    config_.interpolation = PoseInterpolation::kGeodesic;
    config_.max_blind_s = 2.0;
  }
  static NoddingScan at(double stamp_s, const std::optional<Pose2>& T_odom_base) {
    NoddingScan scan;
    scan.record.scan.stamp_s = stamp_s;
    scan.record.T_odom_base = T_odom_base;
    return scan;
  }
  void take(double stamp_s, const std::optional<Pose2>& T_odom_base = {}) { placer().take(at(stamp_s, T_odom_base)); }
  void fix(double stamp_s, const Pose2& T_map_base, const std::optional<Pose2>& T_odom_base = {}) {
    MatchResult match;
    match.T_map_base = T_map_base;
    match.accepted = true;
    placer().take_fix(at(stamp_s, T_odom_base), T_map_base, match);
  }
  ScanPlacer& placer() {
    if (!placer_) {
      placer_ = std::make_unique<ScanPlacer>(
          config_, NoddingScanner{{.height_m = 0.4}, ElevationTable::identity(), 0.0, 0.5}, ScanConfig{},
          [this]() -> const GlobalField& { return field_; },
          PlacedScans{
              *backend_, cloud_, [this](const NoddingPose& pose, const NoddingScan&) { poses_.push_back(pose); }, {}});
    }
    return *placer_;
  }
  [[nodiscard]] const NoddingStatistics& counts() { return placer().statistics(); }
  /// In log order, and the poses that were fixed have a match.
  void expect_scans(std::size_t first, std::size_t count) const {
    ASSERT_EQ(poses_.size(), count);
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(poses_[k].scan, first + k);
  }

  NoddingConfig config_;
  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField field_{*backend_, 0.05, 10, 1U << 20U};
  CloudKeeper cloud_;
  std::vector<NoddingPose> poses_;
  std::unique_ptr<ScanPlacer> placer_;
};

TEST_F(PlacedByHand, BetweenTwoFixesScansLieOnTheWayByTheirTime) {
  EXPECT_FALSE(placer().has_fix());
  fix(0.0, {});
  EXPECT_TRUE(placer().has_fix());
  for (const double stamp_s : {0.25, 0.5, 1.5}) take(stamp_s);
  EXPECT_TRUE(poses_.empty()) << "they wait";
  fix(2.0, {2.0, 0.0, 0.0});
  expect_scans(0, 4);
  placer().finish();
  expect_scans(0, 5);
  const double expected_m[] = {0.0, 0.25, 0.5, 1.5, 2.0};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_THAT(poses_[k].T_map_base, PoseNear({expected_m[k], 0.0, 0.0}, 1e-9, 1e-9)) << k;
    EXPECT_EQ(poses_[k].stamp_s, expected_m[k]);
    EXPECT_EQ(poses_[k].match.has_value(), k == 0 || k == 4);
  }
  EXPECT_EQ(counts().fixes, 2U);
  EXPECT_EQ(counts().between, 3U);
  EXPECT_EQ(counts().by_odometry, 0U);
  EXPECT_EQ(counts().before_first_fix, 0U);
  EXPECT_EQ(counts().without_nod, 5U);
  EXPECT_TRUE(placer().warnings().empty());
}

TEST_F(PlacedByHand, BeforeTheFirstFixAndBehindTheLastTheOdometryLeads) {
  const Pose2 T_odom_map{5.0, -3.0, 1.0};
  take(0.0, T_odom_map * Pose2{1.0, 0.0, 0.2});
  take(0.5);  // as if it stood
  fix(1.0, {3.0, 0.0, 0.0}, T_odom_map * Pose2{3.0, 0.0, 0.0});
  take(1.5, T_odom_map * Pose2{4.0, 0.5, -0.2});
  placer().finish();
  expect_scans(0, 4);
  EXPECT_THAT(poses_[0].T_map_base, PoseNear({1.0, 0.0, 0.2}, 1e-9, 1e-7));
  EXPECT_THAT(poses_[1].T_map_base, PoseNear({1.0, 0.0, 0.2}, 1e-9, 1e-7));
  EXPECT_THAT(poses_[2].T_map_base, PoseNear({3.0, 0.0, 0.0}, 1e-9, 1e-7));
  EXPECT_THAT(poses_[3].T_map_base, PoseNear({4.0, 0.5, -0.2}, 1e-9, 1e-7));
  EXPECT_EQ(counts().before_first_fix, 2U);
  EXPECT_EQ(counts().by_odometry, 1U);
  EXPECT_EQ(counts().between, 0U);
}

// Where the frame of the odometry lies is not known before: it is nobody's motion.
TEST_F(PlacedByHand, ScansBeforeTheFirstOdometryStand) {
  const Pose2 T_odom_map{100.0, 50.0, 1.0};
  take(0.0);
  take(0.5);
  fix(1.0, {3.0, 0.0, 0.0}, T_odom_map);
  take(1.5, T_odom_map * Pose2{1.0, 0.0, 0.0});
  placer().finish();
  expect_scans(0, 4);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_THAT(poses_[k].T_map_base, PoseNear({3.0, 0.0, 0.0}, 1e-9, 1e-9)) << k;
  EXPECT_THAT(poses_[3].T_map_base, PoseNear({4.0, 0.0, 0.0}, 1e-9, 1e-9));
}

TEST_F(PlacedByHand, OdometryThatBeginsBehindAFixMovesNothing) {
  config_.interpolation = PoseInterpolation::kOdometry;
  const Pose2 T_odom_map{100.0, 50.0, 1.0};
  fix(0.0, {3.0, 0.0, 0.0});
  take(0.5);
  take(1.0, T_odom_map);
  take(1.5, T_odom_map * Pose2{0.5, 0.0, 0.0});
  fix(2.0, {4.0, 0.0, 0.0}, T_odom_map * Pose2{1.0, 0.0, 0.0});
  placer().finish();
  expect_scans(0, 5);
  const double expected_m[] = {3.0, 3.0, 3.0, 3.5, 4.0};
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_THAT(poses_[k].T_map_base, PoseNear({expected_m[k], 0.0, 0.0}, 1e-9, 1e-9)) << k;
}

// A match that was not accepted is the prediction of the wheels: it fixes nothing.
TEST_F(PlacedByHand, AScanThatMatchedNothingIsPlacedBetweenFixes) {
  const auto refused = [this](double stamp_s, const Pose2& T_map_base) {
    MatchResult match;
    match.T_map_base = T_map_base;
    match.accepted = false;
    placer().take_fix(at(stamp_s, {}), T_map_base, match);
  };
  refused(0.0, {});  // somewhere the map has to begin
  refused(0.5, {7.0, 7.0, 0.0});
  fix(1.0, {1.0, 0.0, 0.0});
  placer().finish();
  expect_scans(0, 3);
  EXPECT_THAT(poses_[1].T_map_base, PoseNear({0.5, 0.0, 0.0}, 1e-9, 1e-9));
  EXPECT_TRUE(poses_[1].match) << "who counts matches is told";
  EXPECT_EQ(counts().fixes, 2U);
  EXPECT_EQ(counts().between, 1U);
}

TEST_F(PlacedByHand, BlindForScansThatMatchNothingItSaysSo) {
  fix(0.0, {});
  MatchResult match;
  for (const double stamp_s : {1.0, 2.0, 3.0}) placer().take_fix(at(stamp_s, {}), {}, match);
  ASSERT_EQ(placer().warnings().size(), 1U);
  EXPECT_THAT(placer().warnings()[0], testing::HasSubstr("no horizontal scan that matches for more than 2 s"));
}

/// Of a robot whose wheels stand: where its second fix is put, which the match says is there.
class PlacedAtRest : public PlacedByHand {
 protected:
  Pose2 second_fix(const Pose2& T_map_base, const std::optional<Pose2>& T_odom_first,
                   const std::optional<Pose2>& T_odom_second) {
    placer_.reset();
    poses_.clear();
    fix(0.0, {}, T_odom_first);
    fix(1.0, T_map_base, T_odom_second);
    placer().finish();
    return poses_.at(1).T_map_base;
  }
};

TEST_F(PlacedAtRest, AMatchShakesByFourCentimetresAndFifteenMilliradians) {
  const Pose2 odom{5.0, 5.0, 1.0};
  for (const Pose2& shaken :
       {Pose2{0.039, 0.0, 0.0}, Pose2{0.0, -0.039, 0.0}, Pose2{0.0, 0.0, 0.0149}, Pose2{0.0, 0.0, -0.0149}}) {
    EXPECT_EQ(second_fix(shaken, odom, odom), Pose2{});
    EXPECT_EQ(second_fix(shaken, odom, Pose2{5.0, 5.0, 1.001}), shaken) << "the wheels turned";
    EXPECT_EQ(second_fix(shaken, odom, std::nullopt), shaken);
  }
  for (const Pose2& moved :
       {Pose2{0.041, 0.0, 0.0}, Pose2{0.0, -0.041, 0.0}, Pose2{0.0, 0.0, 0.0151}, Pose2{0.0, 0.0, -0.0151}}) {
    EXPECT_EQ(second_fix(moved, odom, odom), moved);
  }
}

TEST_F(PlacedAtRest, WheelsThatStandWhileTheRobotMovesAreBelievedNoMore) {
  const Pose2 odom{5.0, 5.0, 1.0};
  fix(0.0, {}, odom);
  fix(1.0, {0.05, 0.0, 0.0}, odom);
  fix(2.0, {0.06, 0.0, 0.0}, odom);
  placer().finish();
  EXPECT_EQ(poses_.at(1).T_map_base, (Pose2{0.05, 0.0, 0.0}));
  EXPECT_EQ(poses_.at(2).T_map_base, (Pose2{0.06, 0.0, 0.0}));
}

// Two seconds are not too long, and three are.
TEST_F(PlacedByHand, BlindForLongScansGoByTheOdometry) {
  const auto odom = [](double x_m) { return Pose2{10.0 + x_m, 0.0, 0.0}; };
  fix(0.0, {}, odom(0.0));
  take(1.0, odom(0.1));
  take(2.0, odom(0.2));
  EXPECT_TRUE(placer().warnings().empty());
  EXPECT_TRUE(poses_.empty());
  take(3.0, odom(0.3));
  ASSERT_EQ(placer().warnings().size(), 1U);
  EXPECT_THAT(placer().warnings().front(),
              testing::HasSubstr("no horizontal scan for more than 2 s before scan 3: poses by odometry there"));
  expect_scans(0, 3);
  EXPECT_EQ(counts().by_odometry, 3U);
  for (const double stamp_s : {4.0, 5.0}) take(stamp_s, odom(0.1 * stamp_s));
  expect_scans(0, 3);
  take(6.0, odom(0.6));
  expect_scans(0, 6);
  EXPECT_EQ(placer().warnings().size(), 1U) << "once";
  fix(7.0, {0.7, 0.0, 0.0}, odom(0.7));
  placer().finish();
  expect_scans(0, 8);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_THAT(poses_[k].T_map_base, PoseNear({0.1 * static_cast<double>(k), 0.0, 0.0}, 1e-9, 1e-7)) << k;
  }
  EXPECT_EQ(counts().fixes, 2U);
  EXPECT_EQ(counts().by_odometry, 6U);
  EXPECT_EQ(counts().between, 0U);
}

TEST_F(PlacedByHand, AfterAFixItIsSaidAgain) {
  for (const double begin_s : {0.0, 10.0}) {
    fix(begin_s, {});
    for (const double later_s : {1.0, 2.0, 3.0}) take(begin_s + later_s);
  }
  EXPECT_EQ(placer().warnings().size(), 2U);
}

// Steps of a clock that was set, forth or back, are no time.
TEST_F(PlacedByHand, AClockThatWasSetMakesNobodyBlind) {
  fix(0.0, {});
  take(1.0);
  take(100.0);
  take(50.0);
  take(51.0);
  EXPECT_TRUE(placer().warnings().empty());
  take(53.0);  // two seconds are a step
  EXPECT_EQ(placer().warnings().size(), 1U);
}

TEST_F(PlacedByHand, TooLongBeforeTheFirstFixTheOldestScansGo) {
  for (const double stamp_s : {0.0, 1.0, 2.0}) take(stamp_s);
  EXPECT_EQ(counts().dropped, 0U);
  take(3.0);
  take(4.0);
  EXPECT_EQ(counts().dropped, 2U);
  ASSERT_EQ(placer().warnings().size(), 1U);
  EXPECT_THAT(placer().warnings().front(), testing::HasSubstr("what comes before the first is dropped"));
  fix(5.0, {1.0, 2.0, 0.0});
  placer().finish();
  expect_scans(2, 4);
  EXPECT_EQ(counts().before_first_fix, 3U);
  for (const NoddingPose& pose : poses_) EXPECT_THAT(pose.T_map_base, PoseNear({1.0, 2.0, 0.0}, 1e-9, 1e-7));
}

}  // namespace
}  // namespace gdtslam
