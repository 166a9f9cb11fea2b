// The descent along the slope of the cost against the simplex and the geometry of a room.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/descents.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr double kResolution_m = 0.025;

/// The room mapped from a few true poses, on one instruction set.
struct MappedRoom {
  explicit MappedRoom(Isa isa) : backend(make_cpu_backend({.threads = 1, .isa = isa})) {
    for (const Pose2& pose : {Pose2{}, Pose2{0, 0, 2.0}, Pose2{0, 0, -2.0}, Pose2{3.9, 0.2, 0.3}, Pose2{2.5, -1, 3}}) {
      const KeyframeCells keyframe = make_keyframe_cells(
          in_map(to_points(test::scan_of(walls, pose, 0.0), {0.1, 40.0}), pose), kResolution_m, map.radius_cells());
      const MergeStep step{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};
      map.grow_to_hold(keyframe.window);
      local.prepare(keyframe, map);
      local.merge_into(map, step);
    }
    objective.set_cap(map.cap());
  }
  std::vector<PointCells> scan_from(const Pose2& pose) const {
    return in_cells(to_points(test::scan_of(walls, pose, 0.0), {0.1, 40.0}), kResolution_m);
  }

  std::vector<test::Segment> walls = test::furnished_room();
  std::unique_ptr<Backend> backend;
  GlobalField map{*backend, kResolution_m, 20, 1U << 24U};
  LocalField local{*backend, 20};
  Objective objective{map, Interpolation::kBilinear, CostForm::kDistance};
};

TEST(GaussNewton, StaysWhereItIsOffTheMap) {
  MappedRoom room(Isa::kBaseline);
  const std::vector<PointCells> points = room.scan_from({});
  room.objective.set_points(points);
  for (const CellPose& pose : {CellPose{1.0e5F, 0.0F, 0.0F}, CellPose{-1.0e5F, 3.0e6F, 1.0F}}) {
    const LocalMinimum end = minimise_along_slope(room.objective, pose, {});
    EXPECT_EQ(end.pose.x, pose.x);
    EXPECT_EQ(end.pose.y, pose.y);
    EXPECT_EQ(end.pose.theta, pose.theta);
    EXPECT_EQ(end.cost, points.size() * room.map.cap());
  }
}

// 200 starts of the size that the odometry is off between two keyframes.
TEST(GaussNewton, FindsTheTruthAsOftenAsTheSimplexWithAThirdOfItsEvaluations) {
  MappedRoom room(Isa::kBaseline);
  Random random(11);
  int by_simplex = 0;
  int by_slope = 0;
  std::uint64_t simplex_work = 0;
  std::uint64_t slope_work = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Pose2 truth{random.uniform(0.0, 3.5), random.uniform(-0.6, 0.6), random.uniform(-3.0, 3.0)};
    const std::vector<PointCells> points = room.scan_from(truth);
    room.objective.set_points(points);
    const Pose2 start = truth * Pose2{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    const auto is_found = [&](const LocalMinimum& end) {
      const Pose2 off = between(truth, room.objective.to_metres(end.pose));
      return off.translation().norm() < 0.02 && std::fabs(off.theta_rad) < rad_from_deg(0.5);
    };
    const LocalMinimum simplex = minimise_simplex(room.objective, room.objective.to_cells(start), {});
    const LocalMinimum slope = minimise_along_slope(room.objective, room.objective.to_cells(start), {});
    by_simplex += is_found(simplex) ? 1 : 0;
    by_slope += is_found(slope) ? 1 : 0;
    simplex_work += simplex.evaluations;
    slope_work += slope.evaluations;
  }
  EXPECT_GE(by_slope, by_simplex - 4);  // two in a hundred
  EXPECT_GE(by_slope, 180);
  EXPECT_LT(3 * slope_work, simplex_work);
}

}  // namespace
}  // namespace gdtslam
