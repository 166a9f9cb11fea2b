#include "wall_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/cloud/neighbours.hpp"
#include "engine/cloud/registration.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr double kCube_m = 0.1;
constexpr std::uint32_t kNormalNeighbours = 12;
constexpr double kFlatSurface = 0.3;
constexpr double kMostUpwards = 0.3;     // of a wall's normal: 17 degrees
constexpr std::size_t kFewestAbove = 3;  // cubes of wall above each other
constexpr double kResolution_m = 0.05;
constexpr std::size_t kMostSearched = 400;
constexpr std::uint64_t kMostBoxes = 400'000;
constexpr double kPlaceGap_m = 0.005;
constexpr double kElsewhere_m = 1.0;
constexpr double kElsewhereTurn_rad = rad_from_deg(20.0);

// Points of upright surfaces in the plan, a mean for each column of cubes.
std::vector<Point2> wall_plan(std::span<const CloudPoint> cloud) {
  struct Column {
    Point2 sum = Point2::Zero();
    std::size_t cubes = 0;
  };
  const Cloud means = means_of_cubes(cloud, kCube_m);
  const Neighbours neighbours(means);
  std::map<std::pair<std::int64_t, std::int64_t>, Column> columns;
  for (std::uint32_t k = 0; k < means.size(); ++k) {
    const std::optional<Neighbours::Patch> patch = neighbours.patch(k, kNormalNeighbours, kFlatSurface);
    if (!patch || std::fabs(patch->normal.z()) > kMostUpwards) continue;
    const Point3 point = neighbours.point(k);
    Column& column = columns[{std::llround(point.x() / kCube_m), std::llround(point.y() / kCube_m)}];
    column.sum += point.head<2>();
    ++column.cubes;
  }
  std::vector<Point2> plan;
  for (const auto& [place, column] : columns) {
    if (column.cubes >= kFewestAbove) plan.push_back(column.sum / static_cast<double>(column.cubes));
  }
  return plan;
}

// All poses that put b's middle within a's extent, a metre beyond it included.
PoseWindow window_of(const std::vector<Point2>& a) {
  Point2 low = a.front();
  Point2 high = a.front();
  for (const Point2& point : a) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Point2 middle = 0.5 * (low + high);
  const Point2 half = 0.5 * (high - low) + Point2::Constant(1.0);
  return {.centre = {middle.x(), middle.y(), 0.0},
          .half_x_m = half.x(),
          .half_y_m = half.y(),
          .half_theta_rad = std::numbers::pi};
}

}  // namespace

std::vector<WallPlace> find_by_walls(std::span<const CloudPoint> a, std::span<const CloudPoint> b, std::size_t most,
                                     Backend& backend) {
  const std::vector<Point2> a_plan = wall_plan(a);
  std::vector<Point2> b_plan = every_nth(wall_plan(b), kMostSearched);
  std::vector<WallPlace> places;
  if (a_plan.empty() || b_plan.empty()) return places;
  Point2 b_middle = Point2::Zero();
  for (const Point2& point : b_plan) b_middle += point / static_cast<double>(b_plan.size());
  for (Point2& point : b_plan) point -= b_middle;

  std::mutex mutex;
  const FieldCopy field = make_distance_field(a_plan, kResolution_m, backend, mutex);
  Backend* const device = backend.device().kind == "cpu" ? nullptr : &backend;
  const CertifiedMap map(field.view(), backend.host_isa(), CertifiedMap::kAnyWindows, device);
  const std::vector<PointCells> points = in_cells(b_plan, kResolution_m);
  CertifiedOptions options;
  options.gap_m = kPlaceGap_m;
  options.max_boxes = kMostBoxes;
  options.counts_window = false;
  while (places.size() < most) {
    const CertifiedResult found = find_pose(map, points, window_of(a_plan), options);
    if (!std::isfinite(found.mean_cost_m) || found.stop == CertifiedStop::kNothingAllowed) break;
    places.push_back(
        {found.T_map_base * Pose2{-b_middle.x(), -b_middle.y(), 0.0}, found.mean_cost_m, found.certified()});
    options.excluded.push_back({found.T_map_base, kElsewhere_m, kElsewhereTurn_rad});
  }
  return places;
}

}  // namespace gdtslam
