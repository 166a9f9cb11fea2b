// The slope of the cost against finite differences of the field in double precision, and the descent along it against
// the simplex and the geometry of a room.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/descents.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/instruction_sets.hpp"
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

// The robust cost by its definition: bilinear between the centres of cells, in double.
class Definition {
 public:
  Definition(const GlobalField& map, std::span<const PointCells> points, double scale)
      : map_(map), points_(points), scale_(scale) {}
  double cost(const std::array<double, 3>& pose) const {
    double sum = 0.0;
    for (const PointCells& p : points_) {
      const double x = std::cos(pose[2]) * double{p.x} - std::sin(pose[2]) * double{p.y} + pose[0] - 0.5;
      const double y = std::sin(pose[2]) * double{p.x} + std::cos(pose[2]) * double{p.y} + pose[1] - 0.5;
      const double d = std::min(field(x, y), static_cast<double>(map_.cap()));
      sum += d < scale_ ? 0.5 * d * d / scale_ : d - 0.5 * scale_;
    }
    return sum;
  }

 private:
  double field(double x, double y) const {
    const auto column = static_cast<std::int32_t>(std::floor(x));
    const auto row = static_cast<std::int32_t>(std::floor(y));
    const double fx = x - column;
    const double fy = y - row;
    const auto at = [&](std::int32_t i, std::int32_t j) { return static_cast<double>(map_.at({i, j})); };
    return (1 - fy) * ((1 - fx) * at(column, row) + fx * at(column + 1, row)) +
           fy * ((1 - fx) * at(column, row + 1) + fx * at(column + 1, row + 1));
  }
  const GlobalField& map_;
  std::span<const PointCells> points_;
  double scale_;
};

TEST(PoseSlope, IsTheDerivativeOfTheRobustCost) {
  MappedRoom room(Isa::kBaseline);
  Random random(3);
  const double scale_cells = 1.5;
  for (int trial = 0; trial < 60; ++trial) {
    const Pose2 truth{random.uniform(0.0, 3.5), random.uniform(-0.6, 0.6), random.uniform(-3.0, 3.0)};
    const std::vector<PointCells> points = room.scan_from(truth);
    room.objective.set_points(points);
    const CellPose pose = room.objective.to_cells(
        {truth.x_m + random.uniform(-0.1, 0.1), truth.y_m + random.uniform(-0.1, 0.1), truth.theta_rad + 0.03});
    const Linearisation at = room.objective.linearise(pose, static_cast<float>(scale_cells));
    const Definition expected(room.map, points, scale_cells * 256.0);
    const std::array<double, 3> centre{double{pose.x}, double{pose.y}, double{pose.theta}};
    EXPECT_NEAR(at.cost, expected.cost(centre), 1e-4 * at.cost + 1.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = k == 2 ? 1e-7 : 1e-5;  // so short that hardly a point changes cells
      std::array<double, 3> low = centre;
      std::array<double, 3> high = centre;
      low[k] -= h;
      high[k] += h;
      const double slope = (expected.cost(high) - expected.cost(low)) / (2.0 * h);
      const double steepest = 256.0 * static_cast<double>(points.size()) * (k == 2 ? 200.0 : 1.0);
      EXPECT_NEAR(at.gradient[k], slope, 2e-3 * steepest) << trial << " " << k;
    }
  }
}

TEST(PoseSlope, SaysNothingOffTheMap) {
  MappedRoom room(Isa::kBaseline);
  const std::vector<PointCells> points = room.scan_from({});
  room.objective.set_points(points);
  for (const CellPose& pose : {CellPose{1.0e5F, 0.0F, 0.0F}, CellPose{-1.0e5F, 3.0e6F, 1.0F}}) {
    const Linearisation at = room.objective.linearise(pose, 1.0F);
    EXPECT_DOUBLE_EQ(at.cost, static_cast<double>(points.size()) * (room.map.cap() - 128.0));
    for (const double value : at.gradient) EXPECT_EQ(value, 0.0);
    for (const double value : at.curvature) EXPECT_EQ(value, 0.0);
  }
}

TEST(PoseSlope, HasTheSameBitsOnEveryInstructionSet) {
  MappedRoom expected(Isa::kBaseline);
  std::vector<PointCells> points = expected.scan_from({0.3, 0.2, 0.4});
  for (const Isa isa : test::available_isas()) {
    MappedRoom room(isa);
    Random random(5);
    for (std::size_t count : {std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{17}, points.size()}) {
      const std::span<const PointCells> some(points.data(), count);
      expected.objective.set_points(some);
      room.objective.set_points(some);
      for (int trial = 0; trial < 40; ++trial) {
        const CellPose pose{static_cast<float>(random.uniform(-40.0, 60.0)),
                            static_cast<float>(random.uniform(-40.0, 40.0)),
                            static_cast<float>(random.uniform(-3.0, 3.0))};
        const Linearisation a = expected.objective.linearise(pose, 1.0F);
        const Linearisation b = room.objective.linearise(pose, 1.0F);
        ASSERT_EQ(a.cost, b.cost) << to_string(isa) << " " << count;
        ASSERT_EQ(a.gradient, b.gradient) << to_string(isa) << " " << count;
        ASSERT_EQ(a.curvature, b.curvature) << to_string(isa) << " " << count;
      }
    }
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
    const LocalMinimum slope = minimise_gauss_newton(room.objective, room.objective.to_cells(start), {});
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
