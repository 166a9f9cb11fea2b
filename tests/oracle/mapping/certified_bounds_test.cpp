// The bounds that the certified matcher prunes by, against the cost of poses drawn from the boxes that they speak of;
// and the same for the cone bound of the literature, with and without the minorant of the field, to see what such a
// test can find.
#include <algorithm>
#include <cmath>
#include <span>

#include <gtest/gtest.h>

#include "certified_boxes.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam {
namespace {

using test::BoxSize;
using test::checked_margin;
using test::drawn_pose;
using test::FieldKind;
using test::minorant_params;
using test::patch_minorant;
using test::Scene;
using test::TestField;
using test::wide_minorant;

// Sums hide what goes wrong for one point, so half of the scenes have a single one.
Scene make_scene(FieldKind kind, std::uint64_t seed, std::size_t points) {
  Random random(seed);
  Scene scene{test::make_field_scene(kind, points, 0.0, random), {}, {}};
  const double r = TestField::kResolution;
  const Pose2& T = scene.T_map_base;
  scene.anchor = {static_cast<std::int32_t>(std::floor(T.x_m / r)) - 20,
                  static_cast<std::int32_t>(std::floor(T.y_m / r)) + 9};
  scene.centre = {static_cast<float>(T.x_m / r - scene.anchor.x + random.uniform(-2.0, 2.0)),
                  static_cast<float>(T.y_m / r - scene.anchor.y + random.uniform(-2.0, 2.0)),
                  static_cast<float>(T.theta_rad + random.uniform(-0.05, 0.05)), 0};
  return scene;
}

constexpr BoxSize kSizes[] = {{0.5F, 0.004F}, {0.25F, 0.002F},  {0.5F, 0.0F},
                              {0.0F, 0.004F}, {0.03F, 0.0005F}, {0.001F, 1.0e-5F}};
class Bounds : public testing::TestWithParam<FieldKind> {};
INSTANTIATE_TEST_SUITE_P(Fields, Bounds, testing::ValuesIn(test::kFieldKinds), test::kNameOfKind);

TEST_P(Bounds, TheMinorantLiesBelowTheCostEverywhereInItsBox) {
  double below = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    below += checked_margin(make_scene(GetParam(), seed, 60), seed, kSizes, patch_minorant) / 40.0;
    for (std::uint64_t one = 0; one < 10; ++one) {
      checked_margin(make_scene(GetParam(), 100 * seed + one, 1), seed, kSizes, patch_minorant);
    }
  }
  // Else it would hold because it says nothing: less than half a cell a point on average, where the field is no noise.
  EXPECT_LT(below, GetParam() == FieldKind::kNoise ? 700.0 : 128.0);
}

// Points on the map lie within 140 cells: the angle moves them by up to 0.14 cells. Off the map all is the cap.
TEST_P(Bounds, FieldsOfMinorantsLieBelowTheCostToo) {
  constexpr BoxSize kReached[][2] = {
      {{0.24F, 0.001F}, {0.0F, 0.0F}}, {{1.2F, 0.001F}, {0.5F, 0.0F}}, {{2.2F, 0.001F}, {2.4F, 0.0F}}};
  for (std::uint32_t reach = 1; reach <= 3; ++reach) {
    const auto minorant = [reach](const Scene& scene, const BoxSize& size) {
      return wide_minorant(scene, size, reach);
    };
    double below = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      below += checked_margin(make_scene(GetParam(), seed, 60), seed, kReached[reach - 1], minorant) / 20.0;
      for (std::uint64_t one = 0; one < 10; ++one) {
        checked_margin(make_scene(GetParam(), 100 * seed + one, 1), seed, kReached[reach - 1], minorant);
      }
    }
    EXPECT_LT(below, GetParam() == FieldKind::kNoise ? 3072.0 : 320.0 * reach);
  }
}

TEST(Minorant, IsTheSameOnEveryInstructionSet) {
  for (const Isa isa : test::available_isas()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Scene scene = make_scene(FieldKind::kSteps, seed, 60);
      for (const BoxSize& size : kSizes) {
        PoseMinorant::Value values[2];
        int k = 0;
        for (const Isa one : {Isa::kBaseline, isa}) {
          pose_minorant_host(one, minorant_params(scene, size), scene.field.cells.data(), scene.points.data(),
                             &scene.centre, 1, &values[k++]);
        }
        EXPECT_EQ(values[0].constant, values[1].constant);
        EXPECT_EQ(values[0].slope_x, values[1].slope_x);
        EXPECT_EQ(values[0].slope_y, values[1].slope_y);
        EXPECT_EQ(values[0].slope_theta, values[1].slope_theta);
      }
    }
  }
}

// The bound of the literature, from the field's value at the box's centre and its steepest slope, 1 along an axis: sum
// of max(0, f(T_c p) - 2 (w + |p| sin(a/2) sqrt 2)). It needs a field that is nowhere steeper; a merged one is, its
// cone minorant min_y f(y) + |x - y| is not.
enum class ConeField : std::uint8_t { kMinorant, kAsItIs };

std::vector<std::uint16_t> cone_field(const TestField& field, ConeField form) {
  std::vector<std::uint16_t> cells = field.cells;
  if (form == ConeField::kAsItIs) return cells;
  const auto relax = [&](std::size_t cell, std::size_t beside) {
    cells[cell] = static_cast<std::uint16_t>(std::min(cells[cell], static_cast<std::uint16_t>(cells[beside] + 256)));
  };
  // Two sweeps make it exact for |x - y| = |dx| + |dy|, which is never below the Euclidean cone.
  for (std::size_t y = 0; y < field.height; ++y) {
    for (std::size_t x = 0; x < field.width; ++x) {
      const std::size_t cell = y * field.width + x;
      if (x > 0) relax(cell, cell - 1);
      if (y > 0) relax(cell, cell - field.width);
    }
  }
  for (std::size_t cell = cells.size(); cell-- > 0;) {
    if (cell % field.width + 1 < field.width) relax(cell, cell + 1);
    if (cell + field.width < cells.size()) relax(cell, cell + field.width);
  }
  return cells;
}

double cone_bound(const Scene& scene, const TestField& field, const BoxSize& size) {
  double bound = 0.0;
  const CellPose centre{scene.centre.x, scene.centre.y, scene.centre.theta};
  for (const PointCells& point : scene.points) {
    const double range = std::sqrt(static_cast<double>(point.x * point.x + point.y * point.y));
    const double value = test::true_cost(field, {point}, scene.anchor, centre);
    const double sine = sin_cos(static_cast<double>(size.half_angle) / 2.0).sin;
    const double moved = 2.0 * (static_cast<double>(size.half_width) + 0.01 + range * sine * std::sqrt(2.0));
    bound += std::max(0.0, value - 256.0 * moved);
  }
  return bound;
}

// Poses of boxes whose cost lies below the cone bound of their box.
int poses_below_cone_bound(FieldKind kind, ConeField form) {
  int below = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Scene scene = make_scene(kind, seed, 1 + seed % 3);
    TestField field = scene.field;
    field.cells = cone_field(scene.field, form);
    Random random(seed);
    for (const BoxSize& size : {BoxSize{0.5F, 0.004F}, BoxSize{2.0F, 0.02F}}) {
      const double bound = cone_bound(scene, field, size);
      for (int draw = 0; draw < 20; ++draw) {
        const CellPose pose = drawn_pose(scene, size, random);
        below += test::true_cost(scene.field, scene.points, scene.anchor, pose) < bound ? 1 : 0;
      }
    }
  }
  return below;
}

TEST(ConeBound, HoldsOnExactFieldsEitherWay) {
  EXPECT_EQ(poses_below_cone_bound(FieldKind::kExact, ConeField::kAsItIs), 0);
  EXPECT_EQ(poses_below_cone_bound(FieldKind::kExact, ConeField::kMinorant), 0);
}

TEST(ConeBound, FailsOnSteepStepsWithoutTheMinorantAndHoldsWithIt) {
  EXPECT_EQ(poses_below_cone_bound(FieldKind::kSteps, ConeField::kMinorant), 0);
  EXPECT_GT(poses_below_cone_bound(FieldKind::kSteps, ConeField::kAsItIs), 20);
  EXPECT_GT(poses_below_cone_bound(FieldKind::kNoise, ConeField::kAsItIs), 20);
}

}  // namespace
}  // namespace gdtslam
