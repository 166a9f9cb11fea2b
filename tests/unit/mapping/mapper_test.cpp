// The whole of figure 5 on a known drive: poses against truth, in every instruction set and with threads, with odometry
// that is good, missing, frozen or wrong, with scans that are broken.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/mapper_drive.hpp"
#include "support/pose_matchers.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

class MapperTest : public testing::Test {
 protected:
  using OdometryOf = std::optional<Pose2> (*)(std::size_t, const Pose2& truth);

  // Maps the drive and returns the estimates.
  std::vector<MatchResult> map(OdometryOf odometry, const CpuOptions& cpu = {}, const MapperConfig& config = {}) {
    const auto backend = make_cpu_backend(cpu);
    Mapper mapper(config, *backend);
    std::vector<MatchResult> results;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      results.push_back(mapper.process(scans_[i], odometry(i, truth_[i])));
    }
    statistics_ = mapper.statistics();
    return results;
  }

  void expect_truth(const std::vector<MatchResult>& results, double metres, double degrees) const {
    for (std::size_t i = 0; i < results.size(); ++i) {
      ASSERT_THAT(results[i].T_map_base, PoseNear(truth_[i], metres, degrees)) << "scan " << i;
    }
  }

  void SetUp() override {
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      scans_.push_back(test::scan_of(walls_, truth_[i], 0.1 * static_cast<double>(i)));
    }
  }

  std::vector<test::Segment> walls_ = test::furnished_room();
  std::vector<Pose2> truth_ = test::drive_through_room();
  std::vector<LaserScan> scans_;
  MapperStatistics statistics_;
};

std::optional<Pose2> good(std::size_t, const Pose2& truth) { return Pose2{5.0, -3.0, 1.0} * truth; }
std::optional<Pose2> none(std::size_t, const Pose2&) { return std::nullopt; }
std::optional<Pose2> frozen(std::size_t, const Pose2&) { return Pose2{1.0, 2.0, 3.0}; }

TEST_F(MapperTest, FollowsTheTruth) {
  const auto results = map(good);
  expect_truth(results, 0.03, 0.8);
  EXPECT_EQ(statistics_.scans, truth_.size());
  EXPECT_EQ(statistics_.matched, truth_.size());
  EXPECT_EQ(statistics_.doubtful, 0U);
  EXPECT_GT(statistics_.keyframes, 20U);
  EXPECT_LT(statistics_.keyframes, truth_.size());
  double path = 0.0;
  for (std::size_t i = 1; i < truth_.size(); ++i)
    path += (truth_[i].translation() - truth_[i - 1].translation()).norm();
  EXPECT_NEAR(statistics_.path_m, path, 0.05 * path);
}

TEST_F(MapperTest, FollowsTheTruthWithoutOdometry) {
  expect_truth(map(none), 0.05, 1.0);
  EXPECT_EQ(statistics_.without_odometry, truth_.size());
}

TEST_F(MapperTest, FollowsTheTruthWhenOdometryIsFrozen) { expect_truth(map(frozen), 0.05, 1.0); }

TEST_F(MapperTest, SurvivesAFaultOf85DegreesAndHalfAMetreInOneStep) {
  const auto results = map([](std::size_t i, const Pose2& truth) -> std::optional<Pose2> {
    return i < 60 ? truth : Pose2{0.4, -0.25, 1.4835} * truth;
  });
  expect_truth(results, 0.05, 1.0);
  EXPECT_TRUE(results[60].accepted);
  EXPECT_EQ(results[60].doubt, Doubt::kFarFromPrediction) << "a fault that large must be reported";
  EXPECT_EQ(statistics_.doubtful, 1U);
}

TEST_F(MapperTest, ARobotThatIsParkedKeepsItsOdometry) {
  truth_.assign(400, Pose2{0.3, 0.1, 0.2});
  scans_.assign(400, test::scan_of(walls_, truth_[0], 0.0));
  Random random(7);
  for (LaserScan& scan : scans_) {
    for (float& range : scan.ranges_m) range += static_cast<float>(random.normal(0.0, 0.02));
  }
  map(good);
  EXPECT_LE(statistics_.without_odometry, 1U);
}

TEST_F(MapperTest, SurvivesOdometryWithTheSignOfDrivingWrong) {
  expect_truth(map([](std::size_t, const Pose2& truth) -> std::optional<Pose2> {
                 return Pose2{-truth.x_m, -truth.y_m, truth.theta_rad};
               }),
               0.05, 1.0);
}

TEST_F(MapperTest, TheRuleAsPrintedLosesTheRoom) {
  MapperConfig config;
  config.match.matcher = MatcherKind::kSimplex;  // the paper's
  config.search.when = SearchWhen::kNever;
  const auto working = map(good, {}, config);
  config.merge.rule = MergeRule::kLiteral;
  const auto literal = map(good, {}, config);
  double worse = 0.0;
  double better = 0.0;
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    worse += (literal[i].T_map_base.translation() - truth_[i].translation()).norm();
    better += (working[i].T_map_base.translation() - truth_[i].translation()).norm();
  }
  EXPECT_GT(worse, 2.0 * better);
}

TEST_F(MapperTest, RangesThatAreNoReturnChangeNothing) {
  const auto reference = map(good);
  for (LaserScan& scan : scans_) {
    // Three more beams that saw nothing, in three ways of saying so.
    scan.ranges_m.insert(scan.ranges_m.end(), {std::nanf(""), -1.0F, std::numeric_limits<float>::infinity()});
  }
  const auto results = map(good);
  for (std::size_t i = 0; i < results.size(); ++i) EXPECT_EQ(results[i].T_map_base, reference[i].T_map_base);
}

TEST_F(MapperTest, AScanWithoutReturnsKeepsThePredictionAndIsDoubtful) {
  for (std::size_t i = 40; i < 45; ++i) std::fill(scans_[i].ranges_m.begin(), scans_[i].ranges_m.end(), 81.9F);
  scans_[46].ranges_m.clear();
  scans_[47].ranges_m.resize(1);
  const auto results = map(good);
  expect_truth(results, 0.05, 1.0);
  for (const std::size_t i : {40U, 44U, 46U, 47U}) {
    EXPECT_EQ(results[i].doubt, Doubt::kFewPoints);
    EXPECT_FALSE(results[i].accepted);
    EXPECT_FALSE(results[i].merged);
  }
  EXPECT_EQ(statistics_.doubtful, 7U);
}

TEST_F(MapperTest, BearingsOrAMountThatAreNotFiniteGiveNoPoints) {
  scans_[50].first_bearing_rad = std::nan("");
  scans_[51].bearing_step_rad = std::numeric_limits<double>::infinity();
  scans_[52].T_base_laser.x_m = std::nan("");
  scans_[53].T_base_laser.theta_rad = std::nan("");
  const auto results = map(good);
  for (const std::size_t i : {50U, 52U, 53U}) EXPECT_EQ(results[i].doubt, Doubt::kFewPoints) << i;
  expect_truth(results, 0.05, 1.0);
}

TEST_F(MapperTest, AMapThatMayNotGrowIsRefusedAndMappingGoesOn) {
  MapperConfig config;
  config.map.max_megacells = 1;
  config.map.resolution_m = 0.01;
  config.keyframe.every_scan = true;
  const auto backend = make_cpu_backend({});
  Mapper mapper(config, *backend);
  mapper.process(scans_[0], truth_[0]);
  // Most beams as they are, the rest so far from each other that the map would know 2^20 cells.
  LaserScan hall = scans_[1];
  for (std::size_t i = 120; i < hall.ranges_m.size(); ++i) {
    hall.ranges_m[i] = 8.0F + static_cast<float>(i * 37 % 100) / 4.0F;
  }
  hall.ranges_m[0] = 35.0F;
  MatchResult result;
  EXPECT_THROW(result = mapper.process(hall, truth_[1]), InputError);
  result = mapper.process(scans_[2], truth_[2]);
  EXPECT_THAT(result.T_map_predicted, PoseNear(truth_[2], 0.03, 0.8)) << "the motion of the refused scan was lost";
  EXPECT_TRUE(result.accepted);
  EXPECT_THAT(result.T_map_base, PoseNear(truth_[2], 0.03, 0.8));
}

TEST_F(MapperTest, AConfigurationThatCannotBeUsedNamesEveryViolation) {
  MapperConfig config;
  config.map.resolution_m = -1.0;
  config.merge.kappa = 7.0;
  const auto backend = make_cpu_backend({});
  try {
    const Mapper mapper(config, *backend);
    FAIL() << "a negative resolution was accepted";
  } catch (const ConfigError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("map.resolution"), std::string::npos) << text;
    EXPECT_NE(text.find("merge.kappa"), std::string::npos) << text;
  }
}

TEST_F(MapperTest, AScanAsLargeAsALaserCouldNeverMakeIsMapped) {
  scans_[0] = test::scan_of(walls_, truth_[0], 0.0, 100000);
  EXPECT_TRUE(map(good)[0].merged);
}

// As for the first scan, those returns count that are left for matching.
TEST_F(MapperTest, AScanWithTooFewReturnsOnceItIsThinnedIsNotMatched) {
  MapperConfig config;
  config.scan.min_points = 40000;
  const auto backend = make_cpu_backend({});
  Mapper mapper(config, *backend);
  EXPECT_TRUE(mapper.process(test::scan_of(walls_, truth_[0], 0.0, 60000), truth_[0]).merged);
  const MatchResult result = mapper.process(test::scan_of(walls_, truth_[1], 0.1, 70000), truth_[1]);
  EXPECT_EQ(result.points, 35000U);
  EXPECT_EQ(result.doubt, Doubt::kFewPoints);
  EXPECT_FALSE(result.accepted);
}

}  // namespace
}  // namespace gdtslam
