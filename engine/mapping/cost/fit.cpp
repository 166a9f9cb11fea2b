#include "fit.hpp"

#include <algorithm>
#include <cmath>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// A scan fits about as well where the mean distance of its points is so much more; farther points hold nothing.
constexpr double kAboutAsWell = 1.3;
constexpr double kAsWell_m = 0.003;
constexpr double kFarthest_m = 0.3;

}  // namespace

std::array<double, 2> mean_distances_m(const GlobalField& map, std::span<const PointCells> points,
                                       const std::array<Pose2, 2>& poses, double farthest_m) {
  const double unit_m = map.geometry().resolution_m / kFieldOne;
  Objective objective(map, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_anchor(map_cell_at(poses.front().translation(), map.geometry().resolution_m));
  objective.set_points(points);
  objective.set_cap(std::min<std::uint32_t>(map.cap(), static_cast<std::uint32_t>(std::lround(farthest_m / unit_m))));
  const std::array<CellPose, 2> there{objective.to_cells(poses[0]), objective.to_cells(poses[1])};
  std::array<std::uint32_t, 2> costs{};
  objective.evaluate(there, costs);
  const double unit = unit_m / static_cast<double>(std::max<std::size_t>(1, points.size()));
  return {unit * costs[0], unit * costs[1]};
}

bool fits_about_as_well(const GlobalField& map, std::span<const PointCells> points, const Pose2& pose,
                        const Pose2& matched) {
  const auto [there, here] = mean_distances_m(map, points, {matched, pose}, kFarthest_m);
  return here <= kAboutAsWell * there + kAsWell_m;
}

}  // namespace gdtslam
