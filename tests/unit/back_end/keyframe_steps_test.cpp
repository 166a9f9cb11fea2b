// What the back end takes a step from keyframe to keyframe for, of two keyframes whose walls and wheels the test knows:
// variances add up, and so does what independent measurements tell.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/mapping/back_end/back_end.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

/// `count` points along a metre of each of four walls, 3 m away in all directions: a quarter of all normals points
/// each way, and no wall's middle is beside the robot's.
std::vector<Point2> four_walls(std::size_t count) {
  std::vector<Point2> points;
  for (int wall = 0; wall < 4; ++wall) {
    for (std::size_t k = 0; k < count; ++k) {
      const double along_m = static_cast<double>(k) / static_cast<double>(count - 1) - 0.5;
      const Point2 point = wall % 2 == 0 ? Point2{3.0, along_m} : Point2{-along_m, 3.0};
      points.push_back(wall < 2 ? point : Point2{-point.x(), -point.y()});
    }
  }
  return points;
}

/// A match, a metre ahead of the last one, that the wheels have foretold but for `off`.
MatchResult metre_on(double sigma_m, double sigma_rad, const Pose2& off = {}) {
  MatchResult result;
  result.T_odometry_step = {1.0, 0.0, 0.0};
  result.T_map_predicted = {1.0, 0.0, 0.0};
  result.T_map_base = result.T_map_predicted * off;
  result.odometry_sigma_m = result.predicted_sigma_m = sigma_m;
  result.odometry_sigma_rad = result.predicted_sigma_rad = sigma_rad;
  result.accepted = true;
  result.merged = true;
  return result;
}

MeasuredSteps steps_of(const std::vector<Point2>& points, const MatchResult& second) {
  BackEndOptions options;
  options.live.is_beside = false;
  BackEnd back_end(options);
  MatchResult first;
  first.accepted = true;
  first.merged = true;
  std::vector<Point2> from_first;
  for (const Point2& point : points) from_first.push_back(second.T_map_base * point);
  back_end.take(keep_scan(from_first), first);
  back_end.take(keep_scan(points), second);
  (void)back_end.loops().end([](double) {});
  return back_end.loops().path().steps.at(1);
}
const MeasuredStep& by_match(const MeasuredSteps& steps) { return steps[0]; }
const MeasuredStep& by_wheels(const MeasuredSteps& steps) { return steps[1]; }

double relative_error(double value, double expected) { return std::fabs(value / expected - 1.0); }

// A match's points err by 2 cm, twenty of them tell something new, half of them along each axis, and of its error a
// share of 0.15 stays in the path; no keyframe is known better than by 1.5 mm and 0.3 mrad. The wheels count by
// themselves.
TEST(KeyframeSteps, AMatchTellsWhatItsPointsDo) {
  constexpr std::size_t kCount = 20;
  double sq_lever = 0.0;
  for (const Point2& point : four_walls(kCount)) {
    const double along_m = std::fabs(point.x()) == 3.0 ? point.y() : point.x();
    sq_lever += along_m * along_m / (4.0 * kCount);
  }
  const double of_points = 20.0 / (0.15 * 0.15) / (0.02 * 0.02) * 0.5;
  const double of_points_rad = 20.0 / (0.15 * 0.15) / (0.02 * 0.02) * sq_lever;
  for (const double sigma_m : {0.0, 0.004, 1.0}) {
    const MeasuredSteps steps = steps_of(four_walls(kCount), metre_on(sigma_m, 0.1 * sigma_m));
    const Matrix3 covariance = inverse(by_match(steps).information);
    EXPECT_LT(relative_error(covariance(0, 0), 1.0 / of_points + 2.25e-6), 1e-3) << sigma_m;
    EXPECT_LT(relative_error(covariance(1, 1), 1.0 / of_points + 2.25e-6), 1e-3) << sigma_m;
    EXPECT_LT(relative_error(covariance(2, 2), 1.0 / of_points_rad + 9.0e-8), 1e-3) << sigma_m;
    EXPECT_LT(by_match(steps).unseen(0, 0), 1.0e-9) << "all directions are seen";
  }
}

// A match that is 0.3 rad from what was predicted: the wheels are wrong by that, and the match is too unless its scan
// does not fit where the wheels would turn it. How far it is from there in place is open in either case.
TEST(KeyframeSteps, ATurnThatTheScanDoesNotFitWithoutIsTheWheelsFault) {
  MatchResult second = metre_on(0.01, 0.01, Pose2{0.0, 0.4, 0.3});
  for (const bool is_open : {false, true}) {
    second.is_turn_open = is_open;
    const MeasuredSteps steps = steps_of(four_walls(20), second);
    EXPECT_GE(inverse(by_wheels(steps).information)(2, 2), 0.09) << is_open;
    const Matrix3 covariance = inverse(by_match(steps).information);
    EXPECT_EQ(covariance(2, 2) > 0.09, is_open);
    EXPECT_LT(covariance(2, 2), is_open ? 0.1 : 1.0e-4) << is_open;
    EXPECT_GT(covariance(0, 0) + covariance(1, 1), 0.15) << is_open;
  }
}

// Walls that the map does not have yet were matched with nothing: the way is as unsure as the wheels leave it.
TEST(KeyframeSteps, AWallThatIsSeenForTheFirstTimeTellsNothing) {
  BackEndOptions options;
  options.live.is_beside = false;
  MatchResult first;
  first.accepted = first.merged = true;
  std::vector<Point2> corridor;
  for (int k = -60; k <= 60; ++k) corridor.emplace_back(0.05 * k, -1.0);
  const std::vector<Point2> bare = corridor;
  for (int k = 1; k < 40; ++k) corridor.emplace_back(3.0, -1.0 + 0.05 * k);
  for (const bool was_seen : {false, true}) {
    BackEnd once(options);
    std::vector<Point2> before;
    for (const Point2& point : was_seen ? corridor : bare)
      before.emplace_back(point.x() + (was_seen ? 1.0 : 0.0), point.y());
    once.take(keep_scan(before), first);
    once.take(keep_scan(corridor), metre_on(0.1, 0.001));
    (void)once.loops().end([](double) {});
    const double unseen_m = std::sqrt(by_match(once.loops().path().steps.at(1)).unseen(0, 0));
    EXPECT_NEAR(unseen_m, was_seen ? 0.0 : 0.1, 0.005);
  }
}

// A scan that matched nothing for long is laid where the robot was taken to be: how it got there the wheels alone tell,
// or nobody, whatever walls it sees: within five metres and a radian.
TEST(KeyframeSteps, AScanThatMatchedNothingTellsNothing) {
  for (const double sigma_m : {0.004, 1.0, 8.0}) {
    MatchResult second = metre_on(sigma_m, 0.1 * sigma_m);
    second.accepted = false;
    const Matrix3 covariance = inverse(by_match(steps_of(four_walls(20), second)).information);
    EXPECT_GE(covariance(0, 0), 24.9) << sigma_m;
    EXPECT_GE(covariance(2, 2), 0.99) << sigma_m;
  }
}

// Where a scan lies 5 cm from its map, that may be its points' noise: for who asks how sure the path is.
TEST(KeyframeSteps, AMisfitCountsAsNoiseToWhoIsCautious) {
  MatchResult second = metre_on(1.0, 0.1);
  for (const double misfit_m : {0.01, 0.02, 0.05}) {
    second.mean_cost_m = misfit_m;
    const MeasuredStep step = by_match(steps_of(four_walls(20), second));
    const double noise_m = std::max(0.02, misfit_m);
    const auto expected = [](double noise) { return 0.15 * 0.15 / 20.0 * noise * noise / 0.5 + 2.25e-6; };
    EXPECT_LT(relative_error(inverse(step.cautious)(0, 0), expected(noise_m)), 2e-3) << misfit_m;
    EXPECT_LT(relative_error(inverse(step.information)(0, 0), expected(0.02)), 2e-3);
  }
}

struct OffCase {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
  Pose2 off{};
  bool has_leapt = false;
};

// Beyond five sigmas of both, where a match is 2 cm and 10 mrad off at most times, one of the two leapt, and either may
// be wrong by all that lies between them.
TEST(KeyframeSteps, WhereMatchAndWheelsCannotBothBeRightEitherMayBeWrong) {
  const double at_3cm = 5.0 * std::sqrt(0.03 * 0.03 + 0.02 * 0.02);
  const double at_20mrad = 5.0 * std::sqrt(0.02 * 0.02 + 0.01 * 0.01);
  const std::vector<OffCase> cases{{0.0, 0.0, {0.099, 0.0, 0.0}, false},
                                   {0.0, 0.0, {0.101, 0.0, 0.0}, true},
                                   {0.0, 0.0, {0.0, -0.099, 0.0}, false},
                                   {0.0, 0.0, {0.0, -0.101, 0.0}, true},
                                   {0.0, 0.0, {0.06, 0.07, 0.0}, false},
                                   {0.0, 0.0, {0.08, 0.07, 0.0}, true},
                                   {0.0, 0.0, {0.0, 0.0, 0.0495}, false},
                                   {0.0, 0.0, {0.0, 0.0, 0.0505}, true},
                                   {0.03, 0.0, {0.99 * at_3cm, 0.0, 0.0}, false},
                                   {0.03, 0.0, {1.01 * at_3cm, 0.0, 0.0}, true},
                                   {0.0, 0.02, {0.0, 0.0, 0.99 * at_20mrad}, false},
                                   {0.0, 0.02, {0.0, 0.0, 1.01 * at_20mrad}, true}};
  for (const OffCase& one : cases) {
    const MeasuredSteps steps = steps_of(four_walls(15), metre_on(one.sigma_m, one.sigma_rad, one.off));
    const Tangent2 off = log_tangent(one.off);
    Matrix3 expected = Matrix3::diagonal(one.sigma_m * one.sigma_m + 4.0e-6, one.sigma_m * one.sigma_m + 4.0e-6,
                                         one.sigma_rad * one.sigma_rad + 2.5e-7);
    if (one.has_leapt) expected += outer(off, off);
    const Matrix3 found = inverse(by_wheels(steps).information);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(relative_error(found(k, k), expected(k, k)), 1e-6) << one.off.x_m << ' ' << one.off.theta_rad;
    }
    EXPECT_NEAR(found(0, 1), expected(0, 1), 1e-9);
    const double least_of_match = 2.25e-6 + (one.has_leapt ? off[0] * off[0] : 0.0);
    EXPECT_GE(inverse(by_match(steps).information)(0, 0), least_of_match);
  }
}

// A robot without odometry that drove off along a bare corridor seemed to stand, surely, until a match leapt: neither
// the chain of matches nor what nothing measured knows how far it went meanwhile.
TEST(KeyframeSteps, AMatchThatLeapsFromAMotionThatGoesOnMayBeWrongByAsMuch) {
  MatchResult leapt = metre_on(10.0, 3.0, {0.5, 0.0, 0.0});
  leapt.predicted_sigma_m = 0.012;
  leapt.predicted_sigma_rad = 0.005;
  EXPECT_GE(inverse(by_match(steps_of(four_walls(15), leapt)).information)(0, 0), 0.25);
  leapt.predicted_sigma_m = 0.3;  // as far as such a robot may well have gone
  EXPECT_LT(inverse(by_match(steps_of(four_walls(15), leapt)).information)(0, 0), 0.01);
}

}  // namespace
}  // namespace gdtslam
