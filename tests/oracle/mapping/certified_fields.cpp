#include "certified_fields.hpp"

#include <algorithm>
#include <cmath>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/brute_force.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kWidth = 110;
constexpr std::uint32_t kHeight = 90;
constexpr std::uint16_t kCap = 12 * 256;

PoseCost::Params cost_params(const FieldView& field, std::size_t points, CellIndex anchor) {
  return {.width = field.width,
          .height = field.height,
          .stride = field.stride,
          .anchor_x = anchor.x - field.first_cell.x,
          .anchor_y = anchor.y - field.first_cell.y,
          .point_count = static_cast<std::uint32_t>(points),
          .cap = field.cap};
}

// Distances to the cells of a few straight walls, by the definition; walls keep the cap away from the edge.
void fill_exact(TestField& field, Random& random) {
  std::vector<std::pair<double, double>> walls;
  for (int wall = 0; wall < 6; ++wall) {
    double x = random.uniform(5.0, kWidth - 5.0);
    double y = random.uniform(5.0, kHeight - 5.0);
    const double dx = random.uniform(-1.0, 1.0);
    const double dy = random.uniform(-1.0, 1.0);
    for (int k = 0; k < 30; ++k, x += dx, y += dy) {
      walls.emplace_back(std::floor(std::clamp(x, 15.0, kWidth - 15.0)),
                         std::floor(std::clamp(y, 15.0, kHeight - 15.0)));
    }
  }
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      double sq_least = 1.0e9;
      for (const auto& [wx, wy] : walls) sq_least = std::min(sq_least, (x - wx) * (x - wx) + (y - wy) * (y - wy));
      const double least = std::min<double>(kCap, 256.0 * std::sqrt(sq_least));
      field.cells[y * kWidth + x] = static_cast<std::uint16_t>(std::floor(least));
    }
  }
}

void fill_steps(TestField& field, Random& random) {
  fill_exact(field, random);
  const std::uint16_t heights[] = {0, 40, 256, 1500, kCap};
  for (int patch = 0; patch < 60; ++patch) {
    const std::uint64_t left = random.below(kWidth - 12);
    const std::uint64_t low = random.below(kHeight - 12);
    const std::uint64_t wide = 1 + random.below(12);
    const std::uint64_t high = 1 + random.below(12);
    const std::uint16_t height = heights[random.below(5)];
    for (std::uint64_t y = low; y < low + high; ++y) {
      for (std::uint64_t x = left; x < left + wide; ++x) field.cells[y * kWidth + x] = height;
    }
  }
}

void hold_cap_at_edge(TestField& field) {
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const bool edge = x < 2 || y < 2 || x >= kWidth - 2 || y >= kHeight - 2;
      if (edge) field.cells[y * kWidth + x] = kCap;
    }
  }
}

}  // namespace

const char* to_string(FieldKind kind) {
  switch (kind) {
    case FieldKind::kExact:
      return "exact";
    case FieldKind::kSteps:
      return "steps";
    case FieldKind::kNoise:
      return "noise";
  }
  return "unknown";
}

TestField make_field(FieldKind kind, Random& random) {
  TestField field{kWidth, kHeight, kCap, {static_cast<std::int32_t>(random.below(400)) - 200, -17}, {}};
  field.cells.assign(std::size_t{kWidth} * kHeight, kCap);
  if (kind == FieldKind::kExact) fill_exact(field, random);
  if (kind == FieldKind::kSteps) fill_steps(field, random);
  if (kind == FieldKind::kNoise) {
    for (std::uint16_t& cell : field.cells) cell = static_cast<std::uint16_t>(random.below(kCap + 1));
  }
  hold_cap_at_edge(field);
  return field;
}

std::vector<PointCells> make_scan(const TestField& field, const Pose2& T_map_base, std::size_t count, Random& random) {
  const Pose2 T_base_map = inverse(T_map_base);
  std::vector<PointCells> points;
  while (points.size() < count) {
    const auto x = static_cast<std::uint32_t>(random.below(kWidth));
    const auto y = static_cast<std::uint32_t>(random.below(kHeight));
    if (random.uniform() < 0.8 && field.cells[y * kWidth + x] > 300) continue;
    const double off = random.uniform() < 0.05 ? 200.0 : 0.0;
    const Point2 map_m((0.5 + field.first_cell.x + x + random.normal(0.0, 0.3) + off) * TestField::kResolution,
                       (0.5 + field.first_cell.y + y + random.normal(0.0, 0.3)) * TestField::kResolution);
    const Point2 base_m = T_base_map * map_m;
    points.push_back({static_cast<float>(base_m.x() / TestField::kResolution),
                      static_cast<float>(base_m.y() / TestField::kResolution)});
  }
  return points;
}

FieldScene make_field_scene(FieldKind kind, std::size_t points, double margin, Random& random) {
  FieldScene scene;
  scene.field = make_field(kind, random);
  const double r = TestField::kResolution;
  const double x = scene.field.first_cell.x + random.uniform(margin, kWidth - margin);
  const double y = scene.field.first_cell.y + random.uniform(margin, kHeight - margin);
  scene.T_map_base = {x * r, y * r, random.uniform(-3.1, 3.1)};
  scene.points = make_scan(scene.field, scene.T_map_base, points, random);
  return scene;
}

std::uint32_t true_cost(const TestField& field, const std::vector<PointCells>& points, CellIndex anchor,
                        const CellPose& pose) {
  return brute_pose_cost(cost_params(field.view(), points.size(), anchor), field.cells, points,
                         {pose.x, pose.y, pose.theta, 0});
}

std::uint32_t searched_optimum(const FieldView& field, const std::vector<PointCells>& points, const PoseWindow& window,
                               std::uint32_t steps_xy, std::uint32_t steps_theta) {
  const CellIndex anchor = map_cell_at(window.centre.translation(), field.resolution_m);
  const auto at = [](double centre, double half, std::uint32_t i, std::uint32_t steps) {
    return static_cast<float>(centre + half * (2.0 * i / steps - 1.0));
  };
  std::vector<PoseCandidate> poses;
  for (std::uint32_t t = 0; t <= steps_theta; ++t) {
    for (std::uint32_t y = 0; y <= steps_xy; ++y) {
      for (std::uint32_t x = 0; x <= steps_xy; ++x) {
        const double r = field.resolution_m;
        poses.push_back({at(window.centre.x_m / r - anchor.x, window.half_x_m / r, x, steps_xy),
                         at(window.centre.y_m / r - anchor.y, window.half_y_m / r, y, steps_xy),
                         at(window.centre.theta_rad, std::min(window.half_theta_rad, kPi), t, steps_theta), 0});
      }
    }
  }
  std::vector<std::uint32_t> costs(poses.size());
  PoseSimplex::Params walk;
  walk.cost = cost_params(field, points.size(), anchor);
  walk.step_cells = 0.5F;
  walk.step_rad = 0.01F;
  pose_cost_host(Isa::kBaseline, walk.cost, field.cells, points.data(), poses.data(),
                 static_cast<std::uint32_t>(poses.size()), costs.data());
  std::vector<std::size_t> order(poses.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const std::size_t polished = std::min<std::size_t>(40, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(polished), order.end(),
                    [&](std::size_t a, std::size_t b) { return costs[a] < costs[b]; });
  std::uint32_t best = costs[order.front()];
  for (std::size_t i = 0; i < polished; ++i) {
    PolishedPose pose{poses[order[i]].x, poses[order[i]].y, poses[order[i]].theta};
    pose_simplex_host(Isa::kBaseline, walk, field.cells, points.data(), &pose, 1);
    const Pose2 T{(static_cast<double>(pose.x) + anchor.x) * field.resolution_m,
                  (static_cast<double>(pose.y) + anchor.y) * field.resolution_m, static_cast<double>(pose.theta)};
    if (window.holds(T)) best = std::min(best, pose.cost);
  }
  return best;
}

}  // namespace gdtslam::test
