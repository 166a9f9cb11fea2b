#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/thinning.hpp"

namespace gdtslam {
namespace {

constexpr double kBin_m = 0.02;
constexpr double kLeastRoom_m = 1.0;  // least distance between floor and ceiling
constexpr double kColumn_m = 0.25;    // side of the columns over the ground that measure a surface's extent
constexpr int kColumnRounds = 6;
constexpr int kPointRounds = 3;
constexpr int kCandidates = 3;
constexpr double kMostBeyond = 0.05;  // share of points beyond it: stairs down, a mirror, the view through a window
constexpr double kLeastInner = 0.1;   // least share of a surface's columns; a row along the walls has none

using PointSpan = std::span<const CloudPoint>;
using Indices = std::vector<std::uint32_t>;
using ColumnKey = std::array<std::int32_t, 2>;

std::int32_t column_at(float coordinate_m) {
  constexpr double kMost = 1 << 30;
  return static_cast<std::int32_t>(
      std::clamp(std::floor(static_cast<double>(coordinate_m) / kColumn_m), -kMost, kMost));
}

ColumnKey column_at(const CloudPoint& point) { return {column_at(point.x_m), column_at(point.y_m)}; }

/// Lowest and highest point of each column of the ground.
struct ColumnEnds {
  Indices lowest;
  Indices highest;
};

ColumnEnds column_ends(PointSpan points) {
  std::vector<std::tuple<ColumnKey, float, std::uint32_t>> sorted;
  sorted.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) sorted.emplace_back(column_at(points[k]), points[k].z_m, k);
  std::sort(sorted.begin(), sorted.end());
  ColumnEnds ends;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const auto& [column, height, index] = sorted[k];
    if (k == 0 || std::get<0>(sorted[k - 1]) != column) ends.lowest.push_back(index);
    if (k + 1 == sorted.size() || std::get<0>(sorted[k + 1]) != column) ends.highest.push_back(index);
  }
  return ends;
}

// The height at which most of the columns end, within twice a bin.
double commonest_height_m(PointSpan points, const Indices& columns) {
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

Indices near_plane(PointSpan points, const Indices& among, const Plane& plane, double thickness_m) {
  Indices found;
  for (const std::uint32_t k : among) {
    if (std::fabs(plane.distance_m(to_position(points[k]))) <= thickness_m) found.push_back(k);
  }
  return found;
}

// Three standard deviations of the points about their plane, by the median: adjacent walls do not widen it.
double spread_m(PointSpan points, const PlanePatch& patch) {
  std::vector<double> distances;
  distances.reserve(patch.points.size());
  for (const std::uint32_t k : patch.points) {
    distances.push_back(std::fabs(patch.plane.distance_m(to_position(points[k]))));
  }
  return 3.0 * 1.4826 * upper_median(distances);
}

// The points in columns in which nothing rises or falls from the plane. Walls do so: they have points on one side of it
// only, which would shift it by millimetres. All points if few such columns are left.
Indices clear_of_walls(PointSpan points, const Indices& all, const Plane& plane, double thickness_m) {
  std::vector<ColumnKey> walls;
  Indices near;
  for (const std::uint32_t k : all) {
    const double distance_m = std::fabs(plane.distance_m(to_position(points[k])));
    if (distance_m <= thickness_m) near.push_back(k);
    if (distance_m > thickness_m && distance_m <= 4.0 * thickness_m) walls.push_back(column_at(points[k]));
  }
  std::sort(walls.begin(), walls.end());
  const std::size_t total = near.size();
  std::erase_if(near,
                [&](std::uint32_t k) { return std::binary_search(walls.begin(), walls.end(), column_at(points[k])); });
  return 5 * near.size() >= total ? near : all;
}

// The plane of the points within a band about it; the band is as narrow as their noise.
std::optional<PlanePatch> refined(PointSpan points, const Indices& among, Plane plane, double thickness_m) {
  std::optional<PlanePatch> patch;
  double band_m = thickness_m;
  for (int k = 0; k < kPointRounds; ++k) {
    patch = fitted_plane(points, near_plane(points, among, plane, band_m));
    if (!patch) return std::nullopt;
    plane = patch->plane;
    band_m = std::clamp(spread_m(points, *patch), 0.25 * thickness_m, thickness_m);
  }
  return patch;
}

// Starts at the height where most columns end, fits a plane to the columns that end on it, however tilted, and then to
// all points near it. At first only the ends count, because walls would pull a tilted plane level.
std::optional<PlanePatch> plane_at_ends(PointSpan points, const Indices& columns, const Indices& all,
                                        double thickness_m) {
  Plane plane{Point3(0.0, 0.0, 1.0), commonest_height_m(points, columns)};
  for (int k = 0; k < kColumnRounds; ++k) {
    const auto patch =
        fitted_plane(points, near_plane(points, columns, plane, k == 0 ? 2.0 * thickness_m : thickness_m));
    if (!patch) return std::nullopt;
    plane = patch->plane;
  }
  std::optional<PlanePatch> patch = refined(points, all, plane, thickness_m);
  if (patch) patch = refined(points, clear_of_walls(points, all, patch->plane, thickness_m), patch->plane, thickness_m);
  if (patch && patch->plane.normal.z() < 0.0) {
    patch->plane.normal = -patch->plane.normal;
    patch->plane.offset_m = -patch->plane.offset_m;
  }
  return patch;
}

double tilt_sine(const Plane& plane) { return std::sqrt(std::max(0.0, 1.0 - plane.normal.z() * plane.normal.z())); }

// True if enough of the patch's columns have the patch in all eight columns around them.
bool is_wide(PointSpan points, const Indices& patch) {
  std::vector<ColumnKey> columns;
  columns.reserve(patch.size());
  for (const std::uint32_t k : patch) columns.push_back(column_at(points[k]));
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  const auto is_inner = [&columns](const ColumnKey& at) {
    for (const std::int32_t dx : {-1, 0, 1}) {
      for (const std::int32_t dy : {-1, 0, 1}) {
        if (!std::binary_search(columns.begin(), columns.end(), ColumnKey{at[0] + dx, at[1] + dy})) return false;
      }
    }
    return true;
  };
  const auto inner = std::count_if(columns.begin(), columns.end(), is_inner);
  return static_cast<double>(inner) >= kLeastInner * static_cast<double>(columns.size());
}

// The points beyond the plane; `sign` is 1 for a floor, below which they lie, -1 for a ceiling.
Indices beyond(PointSpan points, const Indices& among, const Plane& plane, double sign, double margin_m) {
  Indices found;
  for (const std::uint32_t k : among) {
    if (sign * plane.distance_m(to_position(points[k])) < -margin_m) found.push_back(k);
  }
  return found;
}

// The outermost wide level plane at which columns end. If too many points lie beyond the first plane found, the search
// is repeated on the columns that end there.
std::optional<PlanePatch> find_surface(PointSpan points, Indices columns, const LevelSearch& search, double sign) {
  Indices all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  const auto total = static_cast<double>(points.size());
  const double margin_m = 2.0 * search.thickness_m;
  for (int candidate = 0; candidate < kCandidates && columns.size() >= 3; ++candidate) {
    std::optional<PlanePatch> patch = plane_at_ends(points, columns, all, search.thickness_m);
    if (!patch) return std::nullopt;
    if (static_cast<double>(beyond(points, all, patch->plane, sign, margin_m).size()) <= kMostBeyond * total) {
      const bool is_surface = static_cast<double>(patch->points.size()) >= search.min_share * total &&
                              tilt_sine(patch->plane) <= search.max_tilt_rad && is_wide(points, patch->points);
      return is_surface ? patch : std::nullopt;
    }
    columns = beyond(points, columns, patch->plane, sign, margin_m);
  }
  return std::nullopt;
}

// Height of a point over a level plane, in whichever direction its normal points.
double height_over_m(const Plane& plane, const Point3& point) {
  return plane.normal.z() < 0.0 ? -plane.distance_m(point) : plane.distance_m(point);
}

}  // namespace

LevelSurfaces find_level_surfaces(std::span<const CloudPoint> sample, const LevelSearch& search) {
  const ColumnEnds ends = column_ends(sample);
  LevelSurfaces found{find_surface(sample, ends.lowest, search, 1.0), find_surface(sample, ends.highest, search, -1.0)};
  const bool has_both = found.floor && found.ceiling;
  if (has_both && found.ceiling->centre.z() - found.floor->centre.z() < kLeastRoom_m) {
    // One surface found twice: most other points lie above a floor, or below a ceiling.
    const double middle = 0.5 * (found.floor->centre.z() + found.ceiling->centre.z());
    const auto count = [&sample](auto condition) { return std::count_if(sample.begin(), sample.end(), condition); };
    const auto above =
        count([&](const CloudPoint& p) { return static_cast<double>(p.z_m) > middle + kLeastRoom_m / 2; });
    const auto below =
        count([&](const CloudPoint& p) { return static_cast<double>(p.z_m) < middle - kLeastRoom_m / 2; });
    (below > above ? found.floor : found.ceiling).reset();
  }
  return found;
}

LevelRemoval::LevelRemoval(const LevelSurfaces& surfaces, double margin_m, CloudSink& next)
    : surfaces_(surfaces), margin_m_(margin_m), next_(next) {}

void LevelRemoval::add(std::span<const CloudPoint> points) {
  kept_.clear();
  for (const CloudPoint& point : points) {
    const Point3 p = to_position(point);
    const bool is_floor = surfaces_.floor && height_over_m(surfaces_.floor->plane, p) <= margin_m_;
    const bool is_ceiling = surfaces_.ceiling && height_over_m(surfaces_.ceiling->plane, p) >= -margin_m_;
    if (!is_floor && !is_ceiling) kept_.push_back(point);
  }
  removed_ += points.size() - kept_.size();
  if (!kept_.empty()) next_.add(kept_);
}

}  // namespace gdtslam
