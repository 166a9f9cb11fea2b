#include "certified_boxes.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace gdtslam::test {
namespace {

// A place in [-1, 1], often at an end of it.
double place(Random& random) {
  const double draw = random.uniform(-1.5, 1.5);
  return std::clamp(draw, -1.0, 1.0);
}

}  // namespace

CellPose drawn_pose(const Scene& scene, const BoxSize& size, Random& random) {
  return {scene.centre.x + static_cast<float>(place(random)) * size.half_width,
          scene.centre.y + static_cast<float>(place(random)) * size.half_width,
          scene.centre.theta + static_cast<float>(place(random)) * size.half_angle};
}

PoseMinorant::Params minorant_params(const Scene& scene, const BoxSize& size) {
  return {.width = scene.field.width,
          .height = scene.field.height,
          .stride = scene.field.width,
          .anchor_x = scene.anchor.x - scene.field.first_cell.x,
          .anchor_y = scene.anchor.y - scene.field.first_cell.y,
          .point_count = static_cast<std::uint32_t>(scene.points.size()),
          .cap = scene.field.cap,
          .half_width = size.half_width,
          .half_angle = size.half_angle,
          .slack = scene.slack};
}

PoseMinorant::Value patch_minorant(const Scene& scene, const BoxSize& size) {
  PoseMinorant::Value value;
  pose_minorant_host(Isa::kBaseline, minorant_params(scene, size), scene.field.cells.data(), scene.points.data(),
                     &scene.centre, 1, &value);
  return value;
}

PoseMinorant::Value wide_minorant(const Scene& scene, const BoxSize& size, std::uint32_t reach) {
  const TestField& field = scene.field;
  constexpr std::uint32_t kMargins = 2 * FieldMinorant::kMargin;
  const FieldMinorant::Params make{.width = field.width,
                                   .height = field.height,
                                   .stride = field.width,
                                   .cap = field.cap,
                                   .reach = reach,
                                   .constant_unit = FieldMinorant::unit_for(field.cap)};
  std::vector<std::uint32_t> words(std::size_t{field.width + kMargins} * (field.height + kMargins));
  field_minorant_host(Isa::kBaseline, make, field.cells.data(), words.data());
  std::vector<BoundPoint> points;
  for (const PointCells& point : scene.points) points.push_back({point.x, point.y, 0});
  constexpr auto kMargin = static_cast<std::int32_t>(FieldMinorant::kMargin);
  const PoseMinorantWide::Params params{.width = field.width + kMargins,
                                        .height = field.height + kMargins,
                                        .anchor_x = scene.anchor.x - field.first_cell.x + kMargin,
                                        .anchor_y = scene.anchor.y - field.first_cell.y + kMargin,
                                        .point_count = static_cast<std::uint32_t>(points.size()),
                                        .constant_unit = make.constant_unit,
                                        .half_angle = size.half_angle,
                                        .slack = scene.slack};
  PoseMinorant::Value value;
  pose_minorant_wide_host(Isa::kBaseline, params, words.data(), points.data(), &scene.centre, 1, &value);
  return value;
}

double checked_margin(const Scene& scene, std::uint64_t seed, std::span<const BoxSize> sizes,
                      const MinorantOf& minorant_of) {
  Random random(seed + 1000);
  double below = 0.0;
  int drawn = 0;
  const auto points = static_cast<double>(scene.points.size());
  for (const BoxSize& size : sizes) {
    const PoseMinorant::Value value = minorant_of(scene, size);
    for (int draw = 0; draw < 30; ++draw, ++drawn) {
      const CellPose pose = drawn_pose(scene, size, random);
      const auto apart = [](float a, float b) { return static_cast<double>(a) - static_cast<double>(b); };
      const double dt = apart(pose.theta, scene.centre.theta);
      const double bound = value.constant + value.slope_x * apart(pose.x, scene.centre.x) +
                           value.slope_y * apart(pose.y, scene.centre.y) + value.slope_theta * 16.0 * dt -
                           16.0 * points * std::fabs(dt);
      const double cost = true_cost(scene.field, scene.points, scene.anchor, pose);
      EXPECT_LE(bound, cost) << "seed " << seed << ", half width " << size.half_width;
      below += cost - bound;
    }
  }
  return below / drawn / points;
}

}  // namespace gdtslam::test
