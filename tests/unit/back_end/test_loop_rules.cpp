// The rules of loops at their limits: which cells are free, which earlier places are worth a search, which points
// count.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/mapping/loops/free_space.hpp"
#include "engine/mapping/loops/group_field.hpp"
#include "engine/mapping/loops/point_thinner.hpp"
#include "engine/mapping/loops/revisits.hpp"

namespace gdtslam {
namespace {

// So many equal beams of 5 m from the middle of a cell, which is 0.1 m wide, in a direction along the grid.
FreeSpace seen_along(int beams, double dx, double dy) {
  const Point2 from{0.05, 0.05};
  return FreeSpace(std::vector<Beam>(static_cast<std::size_t>(beams), Beam{from, from + Point2{5.0 * dx, 5.0 * dy}}),
                   {});
}

TEST(FreeSpaceRules, ThreeBeamsMakeACellFreeAndTwoDoNot) {
  EXPECT_FALSE(seen_along(2, 1.0, 0.0).is_free({2.55, 0.05}));
  EXPECT_FALSE(seen_along(2, 1.0, 0.0).is_known({2.55, 0.05}));
  EXPECT_TRUE(seen_along(3, 1.0, 0.0).is_free({2.55, 0.05}));
  EXPECT_TRUE(seen_along(3, 1.0, 0.0).is_known({2.55, 0.05}));
}

// A beam crosses 50 cells and ends in the next: the last two before its end say nothing, for a wall is as thick as its
// noise, and a cell within two of a return is not free.
TEST(FreeSpaceRules, ABeamSaysNothingOfTheTwoCellsBeforeItsReturn) {
  for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, std::pair{-1.0, 0.0}, std::pair{0.0, 1.0}, std::pair{0.0, -1.0}}) {
    const FreeSpace space = seen_along(3, dx, dy);
    const auto cell = [&, x = dx, y = dy](int k) { return Point2{0.05 + 0.1 * k * x, 0.05 + 0.1 * k * y}; };
    for (const int k : {0, 1, 47}) EXPECT_TRUE(space.is_free(cell(k))) << k;
    for (const int k : {48, 49}) {
      EXPECT_FALSE(space.is_known(cell(k))) << k;
      EXPECT_FALSE(space.is_free(cell(k))) << k;
    }
    EXPECT_TRUE(space.is_known(cell(50)));
    EXPECT_FALSE(space.is_free(cell(50)));
    EXPECT_FALSE(space.is_known(cell(51)));
    EXPECT_FALSE(space.is_known(cell(-1)));
  }
}

TEST(FreeSpaceRules, AReturnKeepsTwoCellsAroundItFromBeingFree) {
  for (const int beside : {1, 2, 3, -1, -2, -3}) {
    std::vector<Beam> beams(3, Beam{{0.05, 0.05}, {5.05, 0.05}});
    // A beam that ends beside the others' way, at 2.55 m.
    beams.push_back({{2.55, 0.05 + 3.0 * (beside > 0 ? 1.0 : -1.0)}, {2.55, 0.05 + 0.1 * beside}});
    const FreeSpace space(beams, {});
    EXPECT_EQ(space.is_free({2.55, 0.05}), std::abs(beside) == 3) << beside;
    EXPECT_TRUE(space.is_free({2.85, 0.05})) << "three cells along";
    EXPECT_EQ(space.is_free({2.75, 0.05}), std::abs(beside) == 3) << "two cells along";
  }
}

TEST(FreeSpaceRules, TheFirstWallOfACellCountsAndIsNearWithinTwoCells) {
  const std::vector<Beam> beams{{{0.05, 0.05}, {5.05, 0.05}}, {{0.05, 0.05}, {0.05, 2.05}}};
  const std::vector<WallPoint> walls{
      {{2.51, 0.51}, {0.0, 1.0}}, {{2.59, 0.59}, {1.0, 0.0}}, {{2.61, 0.51}, {-1.0, 0.0}}};
  const FreeSpace space(beams, walls);
  ASSERT_EQ(space.walls().size(), 2U);
  EXPECT_EQ(space.walls()[0].normal, Point2(0.0, 1.0));
  EXPECT_EQ(space.walls()[1].normal, Point2(-1.0, 0.0));
  const auto near = [&](double x, double y) {
    int count = 0;
    space.visit_walls_near({x, y}, [&](const WallPoint&) { ++count; });
    return count;
  };
  EXPECT_EQ(near(2.55, 0.55), 2);
  EXPECT_EQ(near(2.35, 0.55), 1) << "two cells from one, three from the other";
  EXPECT_EQ(near(2.25, 0.55), 0);
  EXPECT_EQ(near(2.75, 0.35), 2);
  EXPECT_EQ(near(2.55, 0.75), 2);
  EXPECT_EQ(near(2.55, 0.85), 0);
  EXPECT_EQ(near(2.55, 0.25), 0);
}

TEST(EveryNth, TakesAtMostSoManyEvenly) {
  std::vector<Point2> points;
  for (std::size_t count = 0; count <= 40; ++count) {
    for (std::size_t most = 1; most <= 42; ++most) {
      const std::vector<Point2> taken = every_nth(points, most);
      EXPECT_LE(taken.size(), most);
      if (count <= most) {
        EXPECT_EQ(taken, points);
      } else {
        EXPECT_GE(2 * taken.size(), most) << count << " of at most " << most;
        for (std::size_t k = 1; k < taken.size(); ++k) {
          EXPECT_EQ(taken[k].x() - taken[k - 1].x(), taken[1].x() - taken[0].x());
        }
        EXPECT_EQ(taken.front(), points.front());
      }
    }
    points.emplace_back(static_cast<double>(count), 0.0);
  }
  std::vector<Point2> ten(points.begin(), points.begin() + 10);
  EXPECT_EQ(every_nth(ten, 5).size(), 5U);
  EXPECT_EQ(every_nth(ten, 4).size(), 4U);  // each third: 0, 3, 6, 9
  EXPECT_EQ(every_nth(ten, 3).size(), 3U);  // each fourth: 0, 4, 8
}

TEST(PointThinner, TakesTheFirstPointOfEachCell) {
  PointThinner thinner(0.5);
  EXPECT_TRUE(thinner.is_first({0.1, 0.1}));
  EXPECT_FALSE(thinner.is_first({0.49, 0.0}));
  EXPECT_TRUE(thinner.is_first({0.5, 0.0}));
  EXPECT_TRUE(thinner.is_first({-0.1, 0.1})) << "the cells on both sides of zero are two";
  EXPECT_TRUE(thinner.is_first({0.1, -0.1}));
  EXPECT_TRUE(thinner.is_first({-0.1, -0.1}));
  EXPECT_FALSE(thinner.is_first({-0.49, -0.49}));
}

TEST(RevisitRules, AWindowIsAsWideAsThePoseIsUnsureUpToItsMost) {
  const RevisitRules rules;
  EXPECT_NEAR(rules.half_m({0, {}, 1.0, 0.0}), 3.0 * 1.0 + 0.3, 1e-12);
  EXPECT_NEAR(rules.half_m({0, {}, 0.0, 0.0}), 0.3, 1e-12);
  EXPECT_NEAR(rules.half_m({0, {}, 10.0, 0.0}), 3.0 * 10.0 + 0.3, 1e-12);
  EXPECT_EQ(rules.half_m({0, {}, 100.0, 0.0}), 40.0);
  EXPECT_NEAR(rules.half_rad({0, {}, 0.0, 0.1}), 3.0 * 0.1 + 0.05, 1e-12);
  EXPECT_EQ(rules.half_rad({0, {}, 0.0, 10.0}), std::numbers::pi);
}

// Two rounds of a square of 10 m, a node each metre: of the second round each node has been before, 40 m of path ago.
class TwoRounds : public testing::Test {
 protected:
  TwoRounds() {
    Pose2 pose;
    for (int k = 0; k < 80; ++k) {
      graph_.poses.push_back(pose);
      path_m_.push_back(static_cast<double>(k));
      const Pose2 step{1.0, 0.0, k % 10 == 9 ? std::numbers::pi / 2.0 : 0.0};
      pose = pose * step;
      if (k > 0) {
        const auto to = static_cast<std::size_t>(k);
        graph_.path.push_back(
            {to - 1, to, between(graph_.poses[to - 1], graph_.poses[to]), Matrix3::diagonal(1e4, 1e4, 1e6)});
      }
    }
  }
  PoseGraph graph_;
  std::vector<double> path_m_;
};

TEST_F(TwoRounds, EachStretchOfThePathIsRevisitedOnceAtItsNearest) {
  const GraphCovariance covariance(graph_);
  const RevisitRules rules;
  for (std::size_t here = 0; here < graph_.poses.size(); ++here) {
    const std::vector<Revisit> found = revisits_of(graph_, covariance, path_m_, here, rules);
    EXPECT_LE(found.size(), rules.most);
    for (const Revisit& revisit : found) {
      EXPECT_GE(path_m_[here] - path_m_[revisit.place], rules.least_path_m);
      const Pose2 T = between(graph_.poses[revisit.place], graph_.poses[here]);
      EXPECT_EQ(revisit.T_place_here, T);
      EXPECT_LE(T.translation().norm(), rules.near_m + rules.half_m(revisit));
      const Matrix3 relative = covariance.relative(revisit.place, here);
      EXPECT_NEAR(revisit.sigma_rad, std::sqrt(relative(2, 2)), 1e-12);
      EXPECT_GE(revisit.sigma_m * revisit.sigma_m, std::max(relative(0, 0), relative(1, 1)) - 1e-12);
      for (const Revisit& other : found) {
        if (other.place == revisit.place) continue;
        EXPECT_GE(std::fabs(path_m_[other.place] - path_m_[revisit.place]), rules.stretch_m);
      }
    }
    if (here < 46) continue;
    // The same place of the round before is there, the nearest that can be; it comes first, for it is the surest, too.
    ASSERT_FALSE(found.empty()) << here;
    EXPECT_EQ(found.front().place, here - 40) << here;
  }
}

TEST_F(TwoRounds, ThePathInBetweenIsLongEnoughAtItsLimit) {
  const GraphCovariance covariance(graph_);
  const auto finds = [&](double least_path_m) {
    RevisitRules rules;
    rules.least_path_m = least_path_m;
    const std::vector<Revisit> found = revisits_of(graph_, covariance, path_m_, 60, rules);
    return std::any_of(found.begin(), found.end(), [](const Revisit& revisit) { return revisit.place == 20; });
  };
  EXPECT_TRUE(finds(40.0));
  EXPECT_FALSE(finds(std::nextafter(40.0, 41.0)));
}

TEST_F(TwoRounds, NoMoreAreGivenThanAskedFor) {
  const GraphCovariance covariance(graph_);
  RevisitRules rules;
  rules.stretch_m = 1.0;
  for (const std::size_t most : {1U, 2U, 3U}) {
    rules.most = most;
    EXPECT_EQ(revisits_of(graph_, covariance, path_m_, 60, rules).size(), most);
  }
}

/// Places at (x, 0), the last one at the origin, and the path until each; each is as sure of the next as told, metres,
/// and surer than that of its heading.
struct PlacesOnALine {
  PoseGraph graph;
  std::vector<double> path_m;

  PlacesOnALine& add(double x_m, double until_m, double sigma_m = 1.0e-5) {
    graph.poses.push_back({x_m, 0.0, 0.0});
    path_m.push_back(until_m);
    if (graph.poses.size() < 2) return *this;
    const std::size_t to = graph.poses.size() - 1;
    const double information = 1.0 / (sigma_m * sigma_m);
    graph.path.push_back({to - 1, to, between(graph.poses[to - 1], graph.poses[to]),
                          Matrix3::diagonal(information, information, 1.0e12)});
    return *this;
  }
  [[nodiscard]] std::vector<std::size_t> revisits(const RevisitRules& rules = {}) const {
    std::vector<std::size_t> places;
    const std::size_t here = graph.poses.size() - 1;
    for (const Revisit& revisit : revisits_of(graph, GraphCovariance(graph), path_m, here, rules)) {
      places.push_back(revisit.place);
    }
    return places;
  }
};
using Places = std::vector<std::size_t>;

TEST(RevisitLimits, APlaceIsNearUpToItsWindow) {
  RevisitRules rules;
  rules.sigmas = 0.0;
  const double limit_m = rules.near_m + rules.least_half_m;
  for (const double sign : {-1.0, 1.0}) {
    const auto found = [&](double x_m) { return PlacesOnALine{}.add(sign * x_m, 0.0).add(0.0, 50.0).revisits(rules); };
    EXPECT_EQ(found(limit_m), Places{0});
    EXPECT_EQ(found(std::nextafter(limit_m, 9.0)), Places{});
  }
}

TEST(RevisitLimits, NoWindowReachesFartherThanTheWidest) {
  const RevisitRules rules;
  const double limit_m = rules.near_m + rules.widest_m;
  const auto found = [](double x_m) { return PlacesOnALine{}.add(x_m, 0.0).add(0.0, 50.0, 100.0).revisits(); };
  EXPECT_EQ(found(limit_m), Places{0});
  EXPECT_EQ(found(std::nextafter(limit_m, 99.0)), Places{});
}

// A wide way outdoors left Freiburg's hospital 10 m unsure, and 15 m off.
TEST(RevisitLimits, APlaceTwentyMetresOffIsLookedForWhereTheGraphIsAsUnsure) {
  const auto found = [](double sigma_m) { return PlacesOnALine{}.add(20.0, 0.0).add(0.0, 50.0, sigma_m).revisits(); };
  EXPECT_EQ(found(10.0), Places{0});
  EXPECT_EQ(found(4.0), Places{});
}

TEST(RevisitLimits, AStretchIsSixMetresOfPathToEitherSide) {
  const auto found = [](double second_m, double first_x_m) {
    return PlacesOnALine{}.add(first_x_m, 0.0).add(1.0, second_m).add(0.0, 50.0).revisits();
  };
  EXPECT_EQ(found(6.0, 2.0), (Places{1, 0}));
  EXPECT_EQ(found(6.0, 0.5), (Places{0, 1}));
  EXPECT_EQ(found(std::nextafter(6.0, 0.0), 2.0), Places{1});
  EXPECT_EQ(found(std::nextafter(6.0, 0.0), 0.5), Places{0});
}

// The two nearest are too far for how sure they are; the third may be here, for all that is known.
TEST(RevisitLimits, TwiceAsManyPlacesAsAreWantedAreAskedFor) {
  PlacesOnALine places;
  places.add(7.0, 0.0).add(6.5, 10.0, 1.0).add(6.0, 20.0).add(0.0, 60.0);
  RevisitRules rules;
  rules.most = 1;
  EXPECT_EQ(places.revisits(rules), Places{});
  rules.most = 2;
  EXPECT_EQ(places.revisits(rules), Places{0});
}

// Of a place 3 m away with a window of half 3.3 m and one that is sure, with 0.3 m, first comes what costs less: the
// metres beyond the window, a fifth of those away and half of the window's. 0.6 + 1.65 m is 1.7 + 0.4 + 0.15 m: 2 m
// away.
TEST(RevisitLimits, FarAndUnsureComesLast) {
  for (const double sign : {-1.0, 1.0}) {
    const auto found = [&](double sure_x_m) {
      return PlacesOnALine{}.add(3.0, 0.0).add(sign * sure_x_m, 20.0, 1.0).add(0.0, 60.0).revisits();
    };
    EXPECT_EQ(found(1.95), (Places{1, 0}));
    EXPECT_EQ(found(2.05), (Places{0, 1}));
  }
}

}  // namespace
}  // namespace gdtslam
