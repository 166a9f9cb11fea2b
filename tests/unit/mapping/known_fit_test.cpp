// How much of a scan a map must know and explain before a robot is followed in it: in a room that is known, with beams
// that are told to see something else.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/tracking/map_tracker.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/pose_matchers.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

const Pose2 kTruth;

class TrackedRoom : public testing::Test {
 protected:
  TrackedRoom() {
    const MapConfig grid;
    GlobalField map(*backend_, grid.resolution_m, grid.radius_cells(), 1U << 24U);
    LocalField local(*backend_, grid.radius_cells());
    for (const double theta_rad : {0.0, 2.0, -2.0}) {
      const Pose2 pose{0.0, 0.0, theta_rad};
      const KeyframeCells keyframe = make_keyframe_cells(in_map(to_points(test::scan_of(walls_, pose, 0.0), {}), pose),
                                                         grid.resolution_m, grid.radius_cells());
      map.grow_to_hold(keyframe.window);
      local.prepare(keyframe, map);
      local.merge_into(map, {.rule = MergeRule::kWorking, .threshold = 256, .lift = 128});
    }
    field_ = std::make_unique<FieldCopy>(map);
    // Left to the tracker.
    config_.doubt.min_overlap = 0.0;
    config_.doubt.max_contradiction = 1.0;
  }
  MapTracker tracker() {
    MapTracker tracker(config_, field_->view(), *backend_);
    tracker.start_at(kTruth);
    return tracker;
  }
  [[nodiscard]] LaserScan scan() const { return test::scan_of(walls_, kTruth, 3.5); }
  /// Every 18 beams so many are changed.
  template <class Change>
  [[nodiscard]] LaserScan scan_with(std::size_t of_eighteen, const Change& change) const {
    LaserScan changed = scan();
    for (std::size_t k = 0; k < changed.ranges_m.size(); ++k) {
      if (7 * k % 18 < of_eighteen) change(changed.ranges_m[k]);
    }
    return changed;
  }

  std::vector<test::Segment> walls_ = test::furnished_room();
  MapperConfig config_;
  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  std::unique_ptr<FieldCopy> field_;
};

TEST_F(TrackedRoom, AScanOfItIsKnownAndExplained) {
  MapTracker here = tracker();
  const MatchResult result = here.process(scan(), std::nullopt);
  EXPECT_TRUE(result.accepted);
  EXPECT_EQ(result.stamp_s, 3.5);
  EXPECT_THAT(result.T_map_base, PoseNear(kTruth, 0.03, 0.5));
  EXPECT_EQ(here.known_fit().share, 1.0);
  EXPECT_GT(here.known_fit().explained, 0.95);
  EXPECT_LT(here.known_fit().mean_distance_m, 0.03);
  EXPECT_LE(here.known_fit().explained_distance_m, here.known_fit().mean_distance_m);
}

TEST_F(TrackedRoom, IsKnownToTenCentimetresWhereTheRobotIsPut) {
  MapTracker here = tracker();
  here.process(scan(), std::nullopt);
  here.start_at({1.0, 2.0, 0.0});
  const PoseCovariance covariance = here.covariance();
  EXPECT_NEAR(covariance.xx, 0.01, 1e-12);
  EXPECT_NEAR(covariance.yy, 0.01, 1e-12);
  EXPECT_NEAR(covariance.tt, 0.0009, 1e-12);
  EXPECT_EQ(covariance.xy, 0.0);
}

// Beams that see far beyond the map.
TEST_F(TrackedRoom, HalfOfAScanMustBeKnown) {
  const auto far = [](float& range_m) { range_m = 20.0F; };
  MapTracker enough = tracker();
  EXPECT_TRUE(enough.process(scan_with(8, far), std::nullopt).accepted);
  EXPECT_NEAR(enough.known_fit().share, 10.0 / 18.0, 1e-9);
  EXPECT_NEAR(enough.known_fit().explained, 10.0 / 18.0, 0.03);
  EXPECT_LT(enough.known_fit().mean_distance_m, 0.03) << "of those that are known";
  MapTracker little = tracker();
  const MatchResult refused = little.process(scan_with(10, far), std::nullopt);
  EXPECT_FALSE(refused.accepted);
  EXPECT_EQ(refused.doubt, Doubt::kLowOverlap);
  EXPECT_EQ(refused.T_map_base, refused.T_map_predicted);
  EXPECT_NEAR(little.known_fit().share, 8.0 / 18.0, 1e-9);
}

// Something stands a quarter of a metre before the walls: known, and not explained.
TEST_F(TrackedRoom, HalfOfWhatIsKnownMustBeExplained) {
  const auto nearer = [](float& range_m) { range_m -= 0.25F; };
  MapTracker enough = tracker();
  EXPECT_TRUE(enough.process(scan_with(7, nearer), std::nullopt).accepted);
  EXPECT_EQ(enough.known_fit().share, 1.0);
  EXPECT_LT(enough.known_fit().explained, 0.75);
  EXPECT_GT(enough.known_fit().mean_distance_m, 0.05);
  EXPECT_LT(enough.known_fit().explained_distance_m, 0.03);
  MapTracker little = tracker();
  const MatchResult refused = little.process(scan_with(12, nearer), std::nullopt);
  EXPECT_FALSE(refused.accepted);
  EXPECT_EQ(refused.doubt, Doubt::kLowOverlap);
}

TEST_F(TrackedRoom, AScanOfFewPointsIsNotMatched) {
  LaserScan few = scan();
  for (std::size_t k = static_cast<std::size_t>(config_.scan.min_points) - 1; k < few.ranges_m.size(); ++k) {
    few.ranges_m[k] = 81.9F;
  }
  MapTracker here = tracker();
  const MatchResult result = here.process(few, std::nullopt);
  EXPECT_FALSE(result.accepted);
  EXPECT_EQ(result.doubt, Doubt::kFewPoints);
  EXPECT_EQ(result.points, static_cast<std::uint32_t>(config_.scan.min_points) - 1);
  LaserScan one_more = scan();
  for (std::size_t k = static_cast<std::size_t>(config_.scan.min_points); k < one_more.ranges_m.size(); ++k) {
    one_more.ranges_m[k] = 81.9F;
  }
  EXPECT_NE(tracker().process(one_more, std::nullopt).doubt, Doubt::kFewPoints);
}

TEST_F(TrackedRoom, AnotherTrackerStandsAtTheOrigin) {
  MapTracker here = tracker();
  here.start_at({1.0, 0.5, 0.7});
  MapTracker other = here.another();
  EXPECT_THAT(other.process(scan(), std::nullopt).T_map_base, PoseNear(kTruth, 0.03, 0.5));
}

}  // namespace
}  // namespace gdtslam
