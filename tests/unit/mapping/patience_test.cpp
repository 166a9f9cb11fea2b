// A laser that is covered, or gives noise: each of its scans is searched for at first, then each eighth, and what it
// sees afterwards is known again.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "engine/mapping/match/match_rules.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/pose_matchers.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

TEST(Patience, EndsAfter64ScansAndThenEachEighthIsSearchedFor) {
  Patience patience;
  for (int refused = 0; refused < 64; ++refused) {
    EXPECT_FALSE(patience.is_over()) << refused;
    patience.take(false);
  }
  for (int refused = 64; refused < 200; ++refused) {
    EXPECT_EQ(patience.is_over(), refused % 8 != 0) << refused;
    patience.take(false);
  }
}

TEST(Patience, IsThereAgainWithTheFirstMatch) {
  Patience patience;
  for (int refused = 0; refused < 67; ++refused) patience.take(false);
  EXPECT_TRUE(patience.is_over());
  patience.take(true);
  for (int refused = 0; refused < 64; ++refused) {
    EXPECT_FALSE(patience.is_over()) << refused;
    patience.take(false);
  }
}

// Of 0.3 m and 0.2 rad, as in the configuration, however far the robot may have gone.
TEST(Patience, WithoutItTheWindowIsTheLeastOne) {
  MapperConfig config;
  config.search.half_m = 0.3;
  config.search.half_rad = 0.2;
  MatchRules rules(config);
  Prediction prediction{.T_map_base = {1.0, 2.0, 0.5}};
  prediction.travelled_m = 3.0;
  prediction.turned_rad = 1.0;
  rules.begin(prediction, 100);
  EXPECT_TRUE(rules.may_search());
  EXPECT_GT(rules.window(1.0).half_xy_cells, 13.0F);
  prediction.is_hopeless = true;
  rules.begin(prediction, 100);
  EXPECT_FALSE(rules.may_search());
  EXPECT_FLOAT_EQ(rules.window(1.0).half_xy_cells, 12.0F);  // of 0.025 m
  EXPECT_FLOAT_EQ(rules.window(1.0).half_theta_rad, 0.2F);
  EXPECT_FLOAT_EQ(rules.window(4.0).half_xy_cells, 12.0F);
}

// A robot that is parked in the room, and noise for so many scans.
class CoveredLaser : public testing::Test {
 protected:
  static constexpr std::size_t kBefore = 3;
  static constexpr std::size_t kCovered = 120;
  static constexpr std::size_t kAfter = 3;

  [[nodiscard]] LaserScan scan(std::size_t i) {
    LaserScan scan = test::scan_of(walls_, kPose, 0.1 * static_cast<double>(i));
    if (i >= kBefore && i < kBefore + kCovered) {
      for (float& range : scan.ranges_m) range = static_cast<float>(random_.uniform(0.2, 8.0));
    }
    return scan;
  }
  std::vector<MatchResult> map(MatcherKind matcher) {
    MapperConfig config;
    config.match.matcher = matcher;
    config.search.when = SearchWhen::kSuspect;
    const auto backend = make_cpu_backend({});
    Mapper mapper(config, *backend);
    std::vector<MatchResult> results;
    for (std::size_t i = 0; i < kBefore + kCovered + kAfter; ++i) results.push_back(mapper.process(scan(i), kPose));
    return results;
  }
  static void expect_refused_and_known_again(const std::vector<MatchResult>& results) {
    for (std::size_t i = kBefore; i < kBefore + kCovered; ++i) ASSERT_FALSE(results[i].accepted) << i;
    for (std::size_t i = kBefore + kCovered; i < results.size(); ++i) {
      EXPECT_TRUE(results[i].accepted) << i;
      EXPECT_THAT(results[i].T_map_base, PoseNear(results[0].T_map_base, 0.02, 0.5)) << i;
    }
  }

  static constexpr Pose2 kPose{0.3, 0.1, 0.2};
  std::vector<test::Segment> walls_ = test::furnished_room();
  Random random_{5};
};

TEST_F(CoveredLaser, IsSearchedForInEachEighthOfItsScansOnly) {
  const std::vector<MatchResult> results = map(MatcherKind::kSimplex);
  expect_refused_and_known_again(results);
  for (std::size_t refused = 0; refused < kCovered; ++refused) {
    const bool is_searched = refused < 64 || refused % 8 == 0;
    EXPECT_EQ(results[kBefore + refused].attempts > 0, is_searched) << refused;
  }
}

TEST_F(CoveredLaser, IsLookedForInOneWindowByTheMatcherThatKnowsWindowsOnly) {
  const std::vector<MatchResult> results = map(MatcherKind::kExhaustive);
  expect_refused_and_known_again(results);
  for (std::size_t refused = 0; refused < kCovered; ++refused) {
    const bool is_searched = refused < 64 || refused % 8 == 0;
    EXPECT_EQ(results[kBefore + refused].attempts > 1, is_searched) << refused;
  }
}

}  // namespace
}  // namespace gdtslam
