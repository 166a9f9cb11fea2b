// Certified matching against brute force: the pose, the bound and what they prove.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "certified_fields.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam {
namespace {

using test::FieldKind;
using test::TestField;

struct Problem : test::FieldScene {
  PoseWindow window;
};

Problem make_problem(FieldKind kind, std::uint64_t seed, std::size_t points = 50) {
  Random random(seed);
  Problem problem{test::make_field_scene(kind, points, 10.0, random), {}};
  const Pose2& T = problem.T_map_base;
  problem.window = {
      {T.x_m + random.uniform(-0.2, 0.2), T.y_m + random.uniform(-0.2, 0.2), T.theta_rad + random.uniform(-0.1, 0.1)},
      0.4,
      0.35,
      0.15};
  return problem;
}

double gap_units(const Problem& problem, double gap_m) {
  return gap_m / TestField::kResolution * 256.0 * static_cast<double>(problem.points.size());
}

class Search : public testing::TestWithParam<FieldKind> {};
INSTANTIATE_TEST_SUITE_P(Fields, Search, testing::ValuesIn(test::kFieldKinds), test::kNameOfKind);

TEST_P(Search, FindsWhatBruteForceFindsAndProvesIt) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Problem problem = make_problem(GetParam(), seed);
    // However much of the map was prepared.
    const CertifiedMap::Windows prepared[] = {CertifiedMap::kAnyWindows, CertifiedMap::kSmallWindows,
                                              CertifiedMap::kNearWindows};
    const CertifiedMap map(problem.field.view(), Isa::kBaseline, prepared[seed % 3]);
    const CertifiedResult found = find_pose(map, problem.points, problem.window, {.gap_m = 0.005});
    const std::uint32_t optimum = test::searched_optimum(problem.field.view(), problem.points, problem.window, 32, 40);
    EXPECT_LE(found.bound, optimum) << "seed " << seed;
    // A field of noise falls by its cap within a cell: its boxes may be as small as they get before the gap is proven.
    if (GetParam() == FieldKind::kNoise && found.stop == CertifiedStop::kResolution) continue;
    EXPECT_LE(found.cost, optimum + gap_units(problem, 0.005)) << "seed " << seed;
    EXPECT_LE(found.gap_m, 0.005);
    EXPECT_EQ(found.stop, CertifiedStop::kGapReached);
    EXPECT_TRUE(problem.window.holds(found.T_map_base));
  }
}

TEST_P(Search, NoBoundOnTheWayLiesAboveTheOptimum) {
  for (std::uint64_t seed = 21; seed <= 26; ++seed) {
    const Problem problem = make_problem(GetParam(), seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline,
                           seed % 2 == 0 ? CertifiedMap::kNearWindows : CertifiedMap::kAnyWindows);
    const std::uint32_t optimum = test::searched_optimum(problem.field.view(), problem.points, problem.window, 32, 40);
    std::uint32_t before = 0;
    for (const std::uint64_t limit : {1U, 100U, 400U, 1000U, 2000U, 4000U}) {
      CertifiedOptions options{.gap_m = 0.0005};
      options.max_boxes = limit;
      const CertifiedResult found = find_pose(map, problem.points, problem.window, options);
      EXPECT_LE(found.bound, optimum) << "seed " << seed << ", " << limit << " boxes";
      EXPECT_GE(found.bound, before) << "seed " << seed << ", " << limit << " boxes";
      before = found.bound;
    }
  }
}

TEST_P(Search, StopsWhereTheWantedBoundIsProven) {
  for (std::uint64_t seed = 61; seed <= 66; ++seed) {
    const Problem problem = make_problem(GetParam(), seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    const std::uint32_t optimum = test::searched_optimum(problem.field.view(), problem.points, problem.window, 32, 40);
    const CertifiedResult full = find_pose(map, problem.points, problem.window, {.gap_m = 0.002});
    CertifiedOptions options{.gap_m = 0.0};
    options.wanted_bound = optimum / 2;
    const CertifiedResult found = find_pose(map, problem.points, problem.window, options);
    EXPECT_EQ(found.stop, CertifiedStop::kBoundReached) << "seed " << seed;
    EXPECT_GE(found.bound, options.wanted_bound) << "seed " << seed;
    EXPECT_LE(found.bound, optimum) << "seed " << seed;
    EXPECT_LT(found.boxes, full.boxes) << "seed " << seed;
    // No proof says that nothing costs less than more than the least cost.
    options.wanted_bound = optimum + optimum / 8 + 1;
    options.max_boxes = 200000;
    EXPECT_LE(find_pose(map, problem.points, problem.window, options).bound, optimum) << "seed " << seed;
  }
}

TEST_P(Search, TellsTheCostOfItsPose) {
  for (std::uint64_t seed = 41; seed <= 44; ++seed) {
    const Problem problem = make_problem(GetParam(), seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    const CertifiedResult found = find_pose(map, problem.points, problem.window);
    const CellIndex anchor = map_cell_at(problem.window.centre.translation(), TestField::kResolution);
    const double r = TestField::kResolution;
    const CellPose pose{static_cast<float>(found.T_map_base.x_m / r - anchor.x),
                        static_cast<float>(found.T_map_base.y_m / r - anchor.y),
                        static_cast<float>(found.T_map_base.theta_rad)};
    // The anchor of the search is another one, so that a point may round to the neighbouring 1/256 cell.
    const std::uint32_t cost = test::true_cost(problem.field, problem.points, anchor, pose);
    const double per_point = std::fabs(static_cast<double>(cost) - static_cast<double>(found.cost)) / 50.0;
    EXPECT_LE(per_point, GetParam() == FieldKind::kExact ? 1.0 : 12.0) << "seed " << seed;
    EXPECT_NEAR(found.mean_cost_m, found.cost / 256.0 * r / 50.0, 1e-12);
    EXPECT_NEAR(found.gap_m, found.mean_cost_m - found.mean_bound_m, 1e-12);
  }
}

TEST(Search, ProvesTightGapsUpToRounding) {
  for (std::uint64_t seed = 61; seed <= 63; ++seed) {
    const Problem problem = make_problem(FieldKind::kExact, seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    const CertifiedResult loose = find_pose(map, problem.points, problem.window, {.gap_m = 0.005});
    const CertifiedResult tight = find_pose(map, problem.points, problem.window, {.gap_m = 0.0008});
    EXPECT_EQ(tight.stop, CertifiedStop::kGapReached);
    EXPECT_LE(tight.gap_m, 0.0008);
    EXPECT_GE(tight.bound, loose.bound);
    EXPECT_LE(tight.cost, loose.cost);
  }
}

// Both ends of a window are included, so one without width has one value. What the oracle finds on the grid is no less
// than the optimum; a window around one value costs few boxes.
TEST_P(Search, WindowsWithoutWidthAreSearchedToo) {
  constexpr double kWidths_m[] = {0.0, 1.0e-9, 2.0e-4};
  constexpr double kWidths_rad[] = {0.0, 1.0e-12, 2.0e-6};
  for (std::uint64_t seed = 1; seed <= 21; ++seed) {
    Problem problem = make_problem(GetParam(), 200 + seed);
    const std::uint64_t narrow = 1 + seed % 7;  // in x, y, theta
    if ((narrow & 1U) != 0) problem.window.half_x_m = kWidths_m[seed % 3];
    if ((narrow & 2U) != 0) problem.window.half_y_m = kWidths_m[seed % 3];
    if ((narrow & 4U) != 0) problem.window.half_theta_rad = kWidths_rad[seed % 3];
    if (seed % 4 == 0) problem.window.centre.theta_rad += 3.0 * kTwoPi;
    const CertifiedMap map(problem.field.view(), Isa::kBaseline,
                           seed % 2 == 0 ? CertifiedMap::kNearWindows : CertifiedMap::kAnyWindows);
    CertifiedOptions options{.gap_m = 0.005};
    options.max_boxes = 200000;
    if (seed % 5 == 0) options.starts = {problem.T_map_base};  // beside the window
    const CertifiedResult found = find_pose(map, problem.points, problem.window, options);
    const std::uint32_t optimum = test::searched_optimum(problem.field.view(), problem.points, problem.window, 24, 40);
    EXPECT_TRUE(problem.window.holds(found.T_map_base)) << "seed " << seed;
    EXPECT_LE(found.bound, optimum) << "seed " << seed;
    if (GetParam() == FieldKind::kNoise && found.stop == CertifiedStop::kResolution) continue;
    EXPECT_EQ(found.stop, CertifiedStop::kGapReached) << "seed " << seed;
    EXPECT_LE(found.cost, optimum + gap_units(problem, 0.005)) << "seed " << seed;
    EXPECT_LE(found.boxes, narrow == 7 ? 200U : 200000U) << "seed " << seed;
  }
}

TEST(Search, IsTheSameOnEveryInstructionSet) {
  for (std::uint64_t seed = 71; seed <= 73; ++seed) {
    const Problem problem = make_problem(FieldKind::kSteps, seed);
    const CertifiedMap plain(problem.field.view(), Isa::kBaseline);
    const CertifiedResult expected = find_pose(plain, problem.points, problem.window);
    for (const Isa isa : test::available_isas()) {
      const CertifiedMap map(problem.field.view(), isa);
      const CertifiedResult found = find_pose(map, problem.points, problem.window);
      EXPECT_EQ(found.T_map_base, expected.T_map_base);
      EXPECT_EQ(found.cost, expected.cost);
      EXPECT_EQ(found.bound, expected.bound);
      EXPECT_EQ(found.boxes, expected.boxes);
      EXPECT_EQ(found.evaluations, expected.evaluations);
    }
  }
}

// What surrounds the map is as unknown as what the map does not know.
TEST(Search, DoesNotDependOnHowFarTheMapReaches) {
  const Problem problem = make_problem(FieldKind::kSteps, 81);
  TestField larger = problem.field;
  const std::uint32_t left = 37;
  const std::uint32_t below = 75;
  larger.width += left + 3;
  larger.height += below + 130;
  larger.first_cell = {problem.field.first_cell.x - 37, problem.field.first_cell.y - 75};
  larger.cells.assign(std::size_t{larger.width} * larger.height, larger.cap);
  for (std::uint32_t y = 0; y < problem.field.height; ++y) {
    for (std::uint32_t x = 0; x < problem.field.width; ++x) {
      larger.cells[(y + below) * larger.width + x + left] = problem.field.cells[y * problem.field.width + x];
    }
  }
  const CertifiedMap small_map(problem.field.view(), Isa::kBaseline);
  const CertifiedMap large_map(larger.view(), Isa::kBaseline);
  const CertifiedResult a = find_pose(small_map, problem.points, problem.window);
  const CertifiedResult b = find_pose(large_map, problem.points, problem.window);
  EXPECT_EQ(a.T_map_base, b.T_map_base);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.bound, b.bound);
  EXPECT_EQ(a.boxes, b.boxes);
}

TEST(Search, AStartOnlyHelps) {
  for (std::uint64_t seed = 91; seed <= 96; ++seed) {
    const Problem problem = make_problem(FieldKind::kExact, seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    const CertifiedResult cold = find_pose(map, problem.points, problem.window);
    CertifiedOptions options;
    options.starts = {cold.T_map_base};
    const CertifiedResult warm = find_pose(map, problem.points, problem.window, options);
    EXPECT_LE(warm.cost, cold.cost);
    EXPECT_LE(warm.boxes, cold.boxes);
    EXPECT_TRUE(warm.certified());
    options.starts = {Pose2{1.0e3, -1.0e3, 2.0}};  // outside the window: of no use, and no harm
    EXPECT_TRUE(find_pose(map, problem.points, problem.window, options).certified());
  }
}

TEST(Search, KeepsToTheLimits) {
  const Problem problem = make_problem(FieldKind::kNoise, 101);
  const CertifiedMap map(problem.field.view(), Isa::kBaseline);
  CertifiedOptions options{.gap_m = 0.005};
  const CertifiedResult first = find_pose(map, problem.points, problem.window, options);
  ASSERT_GT(first.boxes, 4000U);
  options.max_boxes = 3000;
  const CertifiedResult limited = find_pose(map, problem.points, problem.window, options);
  EXPECT_EQ(limited.stop, CertifiedStop::kBoxLimit);
  EXPECT_FALSE(limited.certified());
  EXPECT_GE(limited.boxes, 3000U);
  EXPECT_LE(limited.boxes, 3000U + 16 * 8);
  EXPECT_GT(limited.gap_m, 0.005);
  options.max_boxes = std::numeric_limits<std::uint64_t>::max();
  options.max_seconds = 0.0;
  const CertifiedResult late = find_pose(map, problem.points, problem.window, options);
  EXPECT_EQ(late.stop, CertifiedStop::kTimeLimit);
  EXPECT_LE(late.bound, first.cost);
}

TEST(Search, EveryPoseCostsTheSameOffTheMap) {
  Problem problem = make_problem(FieldKind::kExact, 111);
  problem.window.centre.x_m += 500.0;
  const CertifiedMap map(problem.field.view(), Isa::kBaseline);
  const CertifiedResult found = find_pose(map, problem.points, problem.window);
  const std::uint32_t all = 50U * problem.field.cap;
  EXPECT_EQ(found.cost, all);
  EXPECT_LE(found.bound, all);
  EXPECT_TRUE(found.certified());
}

// Points in the middle of cells that hold 0 among cells that hold the cap, the window on the grid: whole steps.
TEST(Search, HoldsWhereValuesAreAtTheirLimits) {
  TestField field{64, 64, 65280, {-32, -32}, std::vector<std::uint16_t>(64 * 64, 65280)};
  std::vector<PointCells> points;
  for (std::uint32_t k = 0; k < 20; ++k) {
    const std::uint32_t x = 8 + (k * 7) % 48;
    const std::uint32_t y = 8 + (k * 13) % 48;
    field.cells[y * 64 + x] = 0;
    points.push_back({static_cast<float>(x) - 31.5F, static_cast<float>(y) - 31.5F});
  }
  const CertifiedMap map(field.view(), Isa::kBaseline);
  const PoseWindow window{{0.0, 0.0, 0.0}, 0.5, 0.5, 0.3};
  const CertifiedResult found = find_pose(map, points, window, {.gap_m = 0.1});
  EXPECT_LE(found.bound, test::searched_optimum(field.view(), points, window, 40, 60));
  EXPECT_LE(found.gap_m, 0.1);
  EXPECT_NEAR(found.T_map_base.x_m, 0.0, 0.01);
  EXPECT_NEAR(found.T_map_base.y_m, 0.0, 0.01);
}

TEST(Search, TheRunnerUpLiesOutsideWhatIsExcluded) {
  for (std::uint64_t seed = 121; seed <= 124; ++seed) {
    Problem problem = make_problem(FieldKind::kExact, seed);
    problem.window.half_x_m = problem.window.half_y_m = 0.8;
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    const CertifiedResult best = find_pose(map, problem.points, problem.window);
    CertifiedOptions options;
    options.excluded = {{best.T_map_base, 0.3, 0.1}};
    const CertifiedResult second = find_pose(map, problem.points, problem.window, options);
    EXPECT_FALSE(options.excluded.front().hold(second.T_map_base));
    EXPECT_TRUE(second.certified());
    EXPECT_GE(second.cost + gap_units(problem, 0.005), best.cost);
    options.excluded.push_back({second.T_map_base, 0.3, 0.1});
    const CertifiedResult third = find_pose(map, problem.points, problem.window, options);
    for (const ExcludedPoses& excluded : options.excluded) EXPECT_FALSE(excluded.hold(third.T_map_base));
    EXPECT_TRUE(third.certified());
    EXPECT_GE(third.cost + gap_units(problem, 0.005), second.cost);
  }
}

TEST(Search, AWindowThatIsExcludedHasNoPose) {
  const Problem problem = make_problem(FieldKind::kExact, 131);
  const CertifiedMap map(problem.field.view(), Isa::kBaseline);
  CertifiedOptions options;
  options.excluded = {{problem.window.centre, 10.0, 4.0}};
  EXPECT_EQ(find_pose(map, problem.points, problem.window, options).stop, CertifiedStop::kNothingAllowed);
}

TEST(Search, APriorPullsAndIsProven) {
  for (std::uint64_t seed = 141; seed <= 144; ++seed) {
    const Problem problem = make_problem(FieldKind::kSteps, seed);
    const CertifiedMap map(problem.field.view(), Isa::kBaseline);
    CertifiedOptions options;
    options.prior = WindowPrior{.mean = problem.window.centre, .weight_xy = 1.0e7F, .weight_theta = 1.0e9F};
    const CertifiedResult held = find_pose(map, problem.points, problem.window, options);
    EXPECT_NEAR(held.T_map_base.x_m, problem.window.centre.x_m, 0.001);
    EXPECT_NEAR(held.T_map_base.y_m, problem.window.centre.y_m, 0.001);
    EXPECT_TRUE(held.certified());
    options.prior->weight_xy = 30.0F;
    options.prior->weight_theta = 5000.0F;
    const CertifiedResult pulled = find_pose(map, problem.points, problem.window, options);
    const CertifiedResult free = find_pose(map, problem.points, problem.window);
    EXPECT_TRUE(pulled.certified());
    EXPECT_GE(pulled.cost + gap_units(problem, 0.005), free.bound);
    EXPECT_LE(pulled.bound, held.cost);
  }
}

TEST(Search, RefusesWhatItCannotUse) {
  Problem problem = make_problem(FieldKind::kExact, 151);
  const CertifiedMap map(problem.field.view(), Isa::kBaseline);
  EXPECT_THROW(find_pose(map, {}, problem.window), InputError);
  const std::vector<PointCells> many(kMostCertifiedPoints + 1);
  EXPECT_THROW(find_pose(map, many, problem.window), InputError);
  const std::vector<PointCells> nan{{std::numeric_limits<float>::quiet_NaN(), 0.0F}};
  EXPECT_THROW(find_pose(map, nan, problem.window), InputError);
  PoseWindow bad = problem.window;
  bad.half_x_m = std::numeric_limits<double>::infinity();
  EXPECT_THROW(find_pose(map, problem.points, bad), InputError);
  EXPECT_THROW(find_pose(map, problem.points, problem.window, {.gap_m = -1.0}), InputError);
  problem.field.cells[5] = 7;
  EXPECT_THROW(CertifiedMap(problem.field.view(), Isa::kBaseline), InputError);
}

}  // namespace
}  // namespace gdtslam
