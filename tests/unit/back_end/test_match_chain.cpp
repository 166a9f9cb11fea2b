// What a chain of matches tells of the way along a corridor whose end some keyframes see and others do not.
#include <gtest/gtest.h>

#include <vector>

#include "engine/mapping/back_end/match_chain.hpp"

namespace gdtslam {
namespace {

/// A corridor along x, 2 m wide, as a robot in its middle sees it, with a wall so far ahead or without one.
std::vector<Point2> corridor(double end_m = 0.0) {
  std::vector<Point2> points;
  for (int k = -60; k <= 60; ++k) points.emplace_back(0.05 * k, -1.0);
  if (end_m > 0.0) {
    for (int k = 1; k < 40; ++k) points.emplace_back(end_m, -1.0 + 0.05 * k);
  }
  for (int k = 60; k >= -60; --k) points.emplace_back(0.05 * k, 1.0);
  return points;
}

/// A long one, with a post in the middle so far ahead.
std::vector<Point2> corridor_with_post(double post_m) {
  std::vector<Point2> points;
  for (int k = -30; k <= 30; ++k) points.emplace_back(0.1 * k, -1.0);
  points.emplace_back(post_m, 0.0);
  for (int k = 30; k >= -30; --k) points.emplace_back(0.1 * k, 1.0);
  return points;
}

/// A robot that drives along x, each keyframe added to what the next is laid on.
class Drive {
 public:
  /// Variances along and across, beside the last place or of it beside the one before.
  Point2 keyframe(double x_m, const std::vector<Point2>& points, bool is_place = false) {
    const Pose2 T_map_base{x_m, 0.0, 0.0};
    const KeptScan known = surfaces_.known_part(keep_scan(points), T_map_base);
    const Matrix3 covariance = chain_.take(T_map_base, known, surfaces_, is_place);
    surfaces_.add(points, T_map_base);
    return {covariance(0, 0), covariance(1, 1)};
  }

 private:
  MatchChain chain_;
  KnownSurfaces surfaces_;
};

constexpr double kNothing = 10.0;  // m^2, more than three metres either way
constexpr double kMuch = 1.0e-4;

TEST(MatchChain, ABareCorridorTellsNothingAlongIt) {
  Drive drive;
  drive.keyframe(0.0, corridor(), true);
  const Point2 variance = drive.keyframe(0.5, corridor());
  EXPECT_GT(variance.x(), kNothing);
  EXPECT_LT(variance.y(), kMuch);
}

TEST(MatchChain, AWallThatThePlaceSawHoldsAllWhoSeeIt) {
  Drive drive;
  drive.keyframe(0.0, corridor(3.0), true);
  EXPECT_LT(drive.keyframe(0.5, corridor(2.5)).x(), kMuch);
  EXPECT_GT(drive.keyframe(1.0, corridor()).x(), kNothing) << "this one does not";
  EXPECT_LT(drive.keyframe(1.5, corridor(1.5), true).x(), kMuch);
  EXPECT_LT(drive.keyframe(2.0, corridor(1.0)).x(), kMuch) << "beside the next place, which sees it";
}

// A post lies between two beams: it tells the way to a decimetre, the walls across to millimetres.
TEST(MatchChain, APostTellsTheWayAsWellAsItsPlaceIsKnown) {
  Drive drive;
  drive.keyframe(0.0, corridor_with_post(2.5), true);
  const Point2 variance = drive.keyframe(0.5, corridor_with_post(2.0));
  EXPECT_NEAR(variance.x(), 0.1 * 0.1, 0.001);
  EXPECT_LT(variance.y(), kMuch);
}

// The robot went half a metre that nothing measured before anybody saw the wall.
TEST(MatchChain, AWallIsNoSurerThanWhoSawItFirst) {
  Drive drive;
  drive.keyframe(0.0, corridor(), true);
  EXPECT_GT(drive.keyframe(0.5, corridor(4.5)).x(), kNothing) << "the wall is new";
  EXPECT_GT(drive.keyframe(1.0, corridor(4.0), true).x(), kNothing);
  EXPECT_LT(drive.keyframe(1.5, corridor(3.5)).x(), kMuch) << "from there on it is known";
}

}  // namespace
}  // namespace gdtslam
