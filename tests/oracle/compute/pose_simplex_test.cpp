// pose_simplex where the minimum is known: a rectangular room whose walls lie on cells' centres, so that bilinear
// interpolation of its distances is exact near walls, and a scan of it from a pose that the test chose.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/compute/cases/scan_data.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/random.hpp"
#include "support/brute_force.hpp"
#include "support/brute_polish.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kWidth = 140;
constexpr std::uint32_t kHeight = 110;
constexpr std::uint32_t kCap = 20 * 256;
constexpr double kLeft = 20.5, kRight = 110.5, kBottom = 15.5, kTop = 90.5;
constexpr std::int32_t kAnchorX = 60;
constexpr std::int32_t kAnchorY = 50;

class Room : public testing::Test {
 protected:
  Room() : field_(std::size_t{kWidth} * kHeight) {
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        const bool border = x < 2 || y < 2 || x + 2 >= kWidth || y + 2 >= kHeight;
        const double cells = distance_to_walls(x + 0.5, y + 0.5);
        field_[std::size_t{y} * kWidth + x] =
            static_cast<std::uint16_t>(border ? kCap : std::min<long>(kCap, std::lround(256.0 * cells)));
      }
    }
  }

  static double distance_to_walls(double x, double y) {
    const bool inside = x > kLeft && x < kRight && y > kBottom && y < kTop;
    if (inside) {
      return std::min({x - kLeft, kRight - x, y - kBottom, kTop - y});
    }
    return std::hypot(x - std::clamp(x, kLeft, kRight), y - std::clamp(y, kBottom, kTop));
  }

  /// Where beams evenly all around meet the walls, seen from the pose.
  static std::vector<PointCells> scan_from(const PolishedPose& pose, std::size_t beams) {
    std::vector<PointCells> points;
    for (std::size_t i = 0; i < beams; ++i) {
      const double bearing = 2.0 * M_PI * static_cast<double>(i) / static_cast<double>(beams);
      const double angle = bearing + static_cast<double>(pose.theta);
      const double x = kAnchorX + static_cast<double>(pose.x);
      const double y = kAnchorY + static_cast<double>(pose.y);
      const double along_x = ((std::cos(angle) > 0.0 ? kRight : kLeft) - x) / std::cos(angle);
      const double along_y = ((std::sin(angle) > 0.0 ? kTop : kBottom) - y) / std::sin(angle);
      const double range = std::min(along_x, along_y);
      points.push_back({static_cast<float>(range * std::cos(bearing)), static_cast<float>(range * std::sin(bearing))});
    }
    return points;
  }

  static PoseSimplex::Params params_for(std::size_t points) {
    PoseSimplex::Params params;
    params.cost = {.width = kWidth,
                   .height = kHeight,
                   .stride = kWidth,
                   .anchor_x = kAnchorX,
                   .anchor_y = kAnchorY,
                   .point_count = static_cast<std::uint32_t>(points),
                   .cap = kCap};
    return params;
  }

  std::vector<std::uint16_t> field_;
};

PolishedPose pose_at(double x, double y, double theta) {
  PolishedPose pose;
  pose.x = static_cast<float>(x);
  pose.y = static_cast<float>(y);
  pose.theta = static_cast<float>(theta);
  return pose;
}

// Walls all around and a slope of 1 towards each, so the cost has one minimum and no flat place wider than the steps of
// 1/256 cell. The last simplex is smaller than the size to stop at and lies at the minimum: within it or beside it.
TEST_F(Room, EndsAsNearTheTruePoseAsItIsToldToStop) {
  Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const PolishedPose truth = pose_at(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-3.1, 3.1));
    const std::vector<PointCells> points = scan_from(truth, 180);
    const PoseSimplex::Params params = params_for(points.size());
    const PolishedPose start = pose_at(static_cast<double>(truth.x) + random.uniform(-1.5, 1.5),
                                       static_cast<double>(truth.y) + random.uniform(-1.5, 1.5),
                                       static_cast<double>(truth.theta) + random.uniform(-0.03, 0.03));
    for (const Isa isa : available_isas()) {
      PolishedPose pose = start;
      pose_simplex_host(isa, params, field_.data(), points.data(), &pose, 1);
      ASSERT_LT(std::fabs(pose.x - truth.x), 2.0F * params.stop_cells) << trial;
      ASSERT_LT(std::fabs(pose.y - truth.y), 2.0F * params.stop_cells) << trial;
      ASSERT_LT(std::fabs(pose.theta - truth.theta), 2.0F * params.stop_rad) << trial;
      ASSERT_EQ(pose.stop, 1U);
      ASSERT_LT(pose.evaluations, params.max_evaluations);
    }
  }
}

TEST_F(Room, NeverEndsWorseThanItStartedAndSaysWhatTheEndCosts) {
  Random random(12);
  const std::vector<PointCells> points = scan_from({}, 61);
  PoseSimplex::Params params = params_for(points.size());
  params.prior = {.mean_x = 1.0F, .weight_xy = 500.0F, .weight_theta = 1.0e5F, .limit = 3.0e4F};
  const auto cost_of = [&](const PolishedPose& pose) {
    const double dx = static_cast<double>(pose.x) - 1.0;
    const double dy = static_cast<double>(pose.y);
    const double dt = static_cast<double>(pose.theta);
    const double prior = std::min(3.0e4, 500.0 * (dx * dx + dy * dy)) + std::min(3.0e4, 1.0e5 * dt * dt);
    return prior + brute_pose_cost(params.cost, field_, points, {pose.x, pose.y, pose.theta, 0});
  };
  for (int trial = 0; trial < 200; ++trial) {
    params.max_evaluations = static_cast<std::uint32_t>(random.below(90));
    const PolishedPose start = pose_at(random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-4, 4));
    PolishedPose end = start;
    pose_simplex_host(best_isa(), params, field_.data(), points.data(), &end, 1);
    EXPECT_LE(end.cost, cost_of(start) + 0.02);       // float32 of a prior up to 6e4
    EXPECT_NEAR(end.cost, cost_of(end) - 0.5, 0.52);  // cut towards zero
  }
}

// A move costs up to two poses and a shrink three more, and the limit is looked at before each move.
TEST_F(Room, KeepsToItsLimit) {
  Random random(13);
  const std::vector<PointCells> points = scan_from({}, 90);
  PoseSimplex::Params params = params_for(points.size());
  std::array<int, 3> stops{};
  for (std::uint32_t limit = 0; limit < 130; ++limit) {
    params.max_evaluations = limit;
    PolishedPose pose = pose_at(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-0.2, 0.2));
    pose_simplex_host(best_isa(), params, field_.data(), points.data(), &pose, 1);
    EXPECT_LE(pose.evaluations, std::max(4U, limit + 4));
    EXPECT_TRUE(pose.stop == 1 || pose.evaluations >= limit) << limit;
    ++stops.at(pose.stop);
  }
  EXPECT_EQ(stops[0], 0);
  EXPECT_GT(stops[1], 10);
  EXPECT_GT(stops[2], 10);
}

// Nothing to choose between: a simplex of edges 2 and 0.03 can only shrink, 8 times until it is below 0.01 and 0.0002,
// each time with the reflection, the contraction and three vertices costed.
TEST_F(Room, WithoutPointsAndPriorItShrinksOntoItsStart) {
  PoseSimplex::Params params = params_for(0);
  const auto descend = [&](std::uint32_t limit) {
    params.max_evaluations = limit;
    PolishedPose pose = pose_at(1.0, -2.0, 0.0);
    pose.evaluations = 7;
    pose_simplex_host(best_isa(), params, field_.data(), nullptr, &pose, 1);
    EXPECT_EQ(pose.x, 1.0F);
    EXPECT_EQ(pose.y, -2.0F);
    EXPECT_EQ(pose.theta, 0.0F);
    EXPECT_EQ(pose.cost, 0U);
    return std::pair(pose.evaluations, pose.stop);
  };
  EXPECT_EQ(descend(200), std::pair(7U + 44U, 1U));
  EXPECT_EQ(descend(44), std::pair(7U + 44U, 1U));
  EXPECT_EQ(descend(40), std::pair(7U + 44U, 1U));
  EXPECT_EQ(descend(39), std::pair(7U + 39U, 2U));
  EXPECT_EQ(descend(0), std::pair(7U + 4U, 2U));
}

// Edges of 2 and 0.03 halved 8 times are as long as the sizes to stop at here, not shorter.
TEST_F(Room, ASimplexOfJustTheSizeIsNotYetSmall) {
  PoseSimplex::Params params = params_for(0);
  for (const auto& [stop_cells, stop_rad] : {std::pair(0x1p-7F, 1.0F), std::pair(1.0F, 0.03F * 0x1p-8F)}) {
    params.stop_cells = stop_cells;
    params.stop_rad = stop_rad;
    PolishedPose pose;
    pose_simplex_host(best_isa(), params, field_.data(), nullptr, &pose, 1);
    EXPECT_EQ(pose.evaluations, 4U + 9 * 5U);
  }
}

TEST_F(Room, WithoutPointsItFindsThePriorsMean) {
  PoseSimplex::Params params = params_for(0);
  params.prior = {.mean_x = 3.0F, .mean_y = -1.5F, .mean_theta = 0.1F, .weight_xy = 1.0e6F, .weight_theta = 3.0e8F};
  PolishedPose pose;
  pose_simplex_host(best_isa(), params, field_.data(), nullptr, &pose, 1);
  EXPECT_NEAR(pose.x, 3.0F, 0.01F);
  EXPECT_NEAR(pose.y, -1.5F, 0.01F);
  EXPECT_NEAR(pose.theta, 0.1F, 0.001F);
  EXPECT_LT(pose.cost, 300U);
}

TEST_F(Room, StartsThatAreNoPosesCostTheCapAndEnd) {
  constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  const std::vector<PointCells> points = scan_from({}, 33);
  PoseSimplex::Params params = params_for(points.size());
  params.prior = {.weight_xy = 1.0F, .weight_theta = 1.0F, .limit = 1000.0F};
  params.max_evaluations = 5000;
  for (const float odd : {kNoValue, -kNoValue, kInfinite, -kInfinite, 3.4e38F}) {
    for (const Isa isa : available_isas()) {
      PolishedPose poses[] = {{odd, 0.0F, 0.0F}, {0.0F, odd, odd}, {odd, odd, odd}};
      pose_simplex_host(isa, params, field_.data(), points.data(), poses, 3);
      if (!std::isfinite(odd)) {  // no number, no size: the rest decides, and there are only ties to shrink by
        EXPECT_EQ(poses[0].evaluations, 44U);
        EXPECT_EQ(poses[1].evaluations, 44U);
        EXPECT_EQ(poses[2].evaluations, 4U);
      }
      for (const PolishedPose& pose : poses) {
        EXPECT_GE(pose.cost, 33 * kCap + 1000);
        EXPECT_LE(pose.cost, 33 * kCap + 2000);
        EXPECT_LE(pose.evaluations, 5004U);
      }
    }
  }
}

/// A scan in a room or in a field without any shape, with parameters for a walk in it.
struct SimplexScene {
  std::vector<std::uint16_t> field;
  std::vector<PointCells> points;
  PoseSimplex::Params params;

  explicit SimplexScene(Random& random) {
    const CaseSize size{97, 83, 100};
    const bool is_room = random.below(2) == 0;
    const auto count = static_cast<std::uint32_t>(random.below(200));
    const std::uint32_t cap = random.below(2) == 0 ? kCap : 700;
    field = is_room ? room_field(size, cap, random) : slow_field(size, cap, random);
    points = is_room ? room_points(size, count, kTruePose, random) : scattered_points(size, count, random);
    params.cost =
        cost_params(size, count, cap, random.below(2) == 0 ? Interpolation::kBilinear : Interpolation::kNearest,
                    random.below(2) == 0 ? CostForm::kDistance : CostForm::kSquared);
    params.prior = {.mean_x = 2.0F, .mean_y = -1.0F, .mean_theta = 0.28F};
    if (random.below(2) == 0) {
      params.prior.weight_xy = 20.0F * static_cast<float>(count);
      params.prior.weight_theta = 8.0e4F * static_cast<float>(count);
      params.prior.limit = 2.0e4F * static_cast<float>(count);
    }
    params.step_cells = static_cast<float>(random.uniform(-4.0, 4.0));
    params.step_rad = static_cast<float>(random.uniform(-0.1, 0.1));
    params.max_evaluations = static_cast<std::uint32_t>(random.below(200));
  }
};

// Starts near the pose that the scan was taken from, and far off the map.
PolishedPose simplex_start(Random& random) {
  const double spread = random.below(8) == 0 ? 1.0e4 : 4.0;
  PolishedPose start = pose_at(static_cast<double>(kTruePose.x) + random.uniform(-spread, spread),
                               static_cast<double>(kTruePose.y) + random.uniform(-spread, spread),
                               static_cast<double>(kTruePose.theta) + random.uniform(-0.1, 0.1));
  start.evaluations = random.below(4) == 0 ? 0xFFFFFFF0U : 7;
  return start;
}

// Every kind of move, and both reasons to stop.
TEST(SimplexWalk, IsThatOfThePlainProgramBitForBit) {
  Random random(17);
  BruteMoves moves;
  std::array<int, 3> stops{};
  for (int scene = 0; scene < 60; ++scene) {
    const SimplexScene in(random);
    std::vector<PolishedPose> starts(4);
    for (PolishedPose& start : starts) start = simplex_start(random);
    std::vector<PolishedPose> expected;
    for (const PolishedPose& start : starts) {
      expected.push_back(brute_descent(in.params, in.field, in.points, start, &moves));
      ++stops.at(expected.back().stop);
    }
    for (const Isa isa : available_isas()) {
      std::vector<PolishedPose> found = starts;
      pose_simplex_host(isa, in.params, in.field.data(), in.points.data(), found.data(), 4);
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(0, std::memcmp(&found[i], &expected[i], sizeof(PolishedPose))) << to_string(isa) << " " << scene;
      }
    }
  }
  EXPECT_GT(moves.expansions, 20U);
  EXPECT_GT(moves.overshoots, 20U);
  EXPECT_GT(moves.reflections, 20U);
  EXPECT_GT(moves.outside, 20U);
  EXPECT_GT(moves.inside, 20U);
  EXPECT_GT(moves.shrinks, 20U);
  EXPECT_GT(stops[1], 20);
  EXPECT_GT(stops[2], 20);
}

}  // namespace
}  // namespace gdtslam::test
