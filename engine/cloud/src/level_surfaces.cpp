#include <algorithm>
#include <cmath>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "position_of.hpp"

namespace gdtslam {
namespace {

constexpr double kBin_m = 0.02;
constexpr double kLeastRoom_m = 1.0;  // between floor and ceiling
constexpr int kRefinements = 4;
constexpr double kColumn_m = 0.25;  // of the grid over the ground that a surface's extent is counted in

struct Extent {
  float x = 0.0F;
  float y = 0.0F;
  int width = 0;
  int height = 0;
};

constexpr int kMostColumnsAlong = 4000;

Extent extent_of(std::span<const CloudPoint> points) {
  const auto [left, right] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.x_m < b.x_m; });
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.y_m < b.y_m; });
  const auto columns = [](float from, float to) {
    return std::min(kMostColumnsAlong, static_cast<int>(static_cast<double>(to - from) / kColumn_m) + 1);
  };
  return {left->x_m, low->y_m, columns(left->x_m, right->x_m), columns(low->y_m, high->y_m)};
}

// Of each column of the ground the lowest (sign 1) or highest (sign -1) point.
std::vector<std::uint32_t> outermost(std::span<const CloudPoint> points, const Extent& extent, float sign) {
  constexpr auto kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> best(static_cast<std::size_t>(extent.width) * static_cast<std::size_t>(extent.height),
                                  kNone);
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const int column =
        std::min(extent.width - 1, static_cast<int>(static_cast<double>(points[k].x_m - extent.x) / kColumn_m));
    const int row =
        std::min(extent.height - 1, static_cast<int>(static_cast<double>(points[k].y_m - extent.y) / kColumn_m));
    std::uint32_t& at =
        best[static_cast<std::size_t>(row) * static_cast<std::size_t>(extent.width) + static_cast<std::size_t>(column)];
    if (at == kNone || sign * points[k].z_m < sign * points[at].z_m) at = k;
  }
  std::erase(best, kNone);
  return best;
}

// The height at which most of the columns end, within twice a bin.
double commonest_height_m(std::span<const CloudPoint> points, const std::vector<std::uint32_t>& columns) {
  std::vector<double> heights;
  heights.reserve(columns.size());
  for (const std::uint32_t k : columns) heights.push_back(static_cast<double>(points[k].z_m));
  std::sort(heights.begin(), heights.end());
  std::size_t best = 0;
  double height = heights.front();
  std::size_t begin = 0;
  for (std::size_t end = 0; end < heights.size(); ++end) {
    while (heights[end] - heights[begin] > 2.0 * kBin_m) ++begin;
    if (end - begin + 1 > best) {
      best = end - begin + 1;
      height = heights[begin + (end - begin) / 2];
    }
  }
  return height;
}

std::vector<std::uint32_t> near_plane(std::span<const CloudPoint> points, const Plane& plane, double thickness_m) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    if (std::fabs(plane.distance_m(position_of(points[k]))) <= thickness_m) found.push_back(k);
  }
  return found;
}

// The level plane at which the columns end, refined on all points near it; nothing where few end there, where it is
// tilted too much, or where more than a few points lie beyond it.
std::optional<PlanePatch> surface_of(std::span<const CloudPoint> points, const std::vector<std::uint32_t>& columns,
                                     const LevelSearch& search, double sign) {
  Plane plane{Point3(0.0, 0.0, 1.0), commonest_height_m(points, columns)};
  PlanePatch patch;
  for (int k = 0; k < kRefinements; ++k) {
    const double thickness_m = k == 0 ? 2.0 * search.thickness_m : search.thickness_m;
    const std::vector<std::uint32_t> near = near_plane(points, plane, thickness_m);
    if (static_cast<double>(near.size()) < search.min_share * static_cast<double>(points.size()) || near.size() < 3) {
      return std::nullopt;
    }
    patch = fit_plane(points, near);
    if (patch.plane.normal.z() < 0.0) {
      patch.plane.normal = -patch.plane.normal;
      patch.plane.offset_m = -patch.plane.offset_m;
    }
    const double level = std::sqrt(std::max(0.0, 1.0 - patch.plane.normal.z() * patch.plane.normal.z()));
    if (level > search.max_tilt_rad) return std::nullopt;
    plane = patch.plane;
  }
  constexpr double kMostBeyond = 0.05;  // of the columns: stairs down, a mirror, a window over a lower roof
  const auto beyond = std::count_if(columns.begin(), columns.end(), [&](std::uint32_t k) {
    return sign * plane.distance_m(position_of(points[k])) < -2.0 * search.thickness_m;
  });
  if (static_cast<double>(beyond) > kMostBeyond * static_cast<double>(columns.size())) return std::nullopt;
  return patch;
}

}  // namespace

LevelSurfaces find_level_surfaces(std::span<const CloudPoint> sample, const LevelSearch& search) {
  if (sample.size() < 3) return {};
  const Extent extent = extent_of(sample);
  LevelSurfaces found{surface_of(sample, outermost(sample, extent, 1.0F), search, 1.0),
                      surface_of(sample, outermost(sample, extent, -1.0F), search, -1.0)};
  const bool has_both = found.floor && found.ceiling;
  if (has_both && found.ceiling->centre.z() - found.floor->centre.z() < kLeastRoom_m) {
    // One surface seen from above and below: what fewer points lie beyond decides.
    const double middle = 0.5 * (found.floor->centre.z() + found.ceiling->centre.z());
    const auto above = std::count_if(sample.begin(), sample.end(), [middle](const CloudPoint& p) {
      return static_cast<double>(p.z_m) > middle + kLeastRoom_m / 2.0;
    });
    (above > 0 ? found.ceiling : found.floor).reset();
  }
  return found;
}

}  // namespace gdtslam
