#include "cloud_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "engine/cloud/neighbours.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kLowShare = 0.01;
constexpr double kHighShare = 0.99;

double first_stamp(std::span<const CloudPoint> cloud) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const CloudPoint& point : cloud) {
    if (std::isfinite(point.stamp_s)) first_s = std::min(first_s, point.stamp_s);
  }
  return std::isfinite(first_s) ? first_s : 0.0;
}

struct Meaning {
  const char* quantity;
  const char* unit;
};
/// In the order of CloudColour.
constexpr std::array<Meaning, 6> kMeanings{
    {{"Height", "m"}, {"Elevation", "°"}, {"Time", "s"}, {"Scan", ""}, {"Distance", "m"}, {"", ""}}};

// Sequential maps with the least value nearest to the background, so that high, late or far points stand out.
const char* suitable_map(const CloudLook& look) { return look.is_dark ? "lagoon" : "tide"; }

constexpr std::size_t kLevelSample = 250000;
constexpr double kStrayLevelShare = 0.001;

constexpr std::size_t kDensitySample = 20000;  // number of points from which the common spacing is estimated
constexpr double kCubesAlong = 400.0;          // cubes along the cloud's longest side at the finest level
constexpr double kLeastCube_m = 0.02;
constexpr double kCoarsestCubesAlong = 10.0;
constexpr double kGapsPerCube = 3.0;    // least number per cube's edge for a reliable count
constexpr double kLargestGap_m = 0.05;  // isolated points are not enlarged beyond this
constexpr double kGapsPerMedian = 2.0;  // except in clouds that are sparse everywhere
constexpr int kBits = 21;  // width of a coordinate in a key; farther cubes share keys, which only makes points smaller

std::uint64_t cube_index(float coordinate_m, double cube_m) {
  const auto cell = static_cast<std::int64_t>(std::floor(static_cast<double>(coordinate_m) / cube_m));
  return static_cast<std::uint64_t>(cell) & ((std::uint64_t{1} << kBits) - 1);
}

}  // namespace

CloudValues::CloudValues(CloudColour colour, std::span<const CloudPoint> cloud, std::span<const float> distances_m)
    : colour_(colour), cloud_(cloud), distances_m_(distances_m) {
  if (colour == CloudColour::kTime) first_s_ = first_stamp(cloud);
}

float CloudValues::at(std::size_t k) const {
  const CloudPoint& point = cloud_[k];
  switch (colour_) {
    case CloudColour::kHeight:
      return point.z_m;
    case CloudColour::kElevation:
      return static_cast<float>(deg_from_rad(static_cast<double>(point.elevation_rad)));
    case CloudColour::kTime:
      return static_cast<float>(point.stamp_s - first_s_);
    case CloudColour::kScan:
      return static_cast<float>(point.scan);
    case CloudColour::kDistance:
      return distances_m_[k];
    case CloudColour::kPlain:
      break;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

ColourScale colour_scale(const CloudLook& look, const CloudValues& values, std::span<const std::uint32_t> drawn) {
  const Meaning meaning = kMeanings.at(static_cast<std::size_t>(look.colour));
  ColourScale scale{.quantity = meaning.quantity, .unit = meaning.unit, .least = 0.0, .most = 1.0, .colour_map = {}};
  scale.colour_map = look.colour_map.empty() ? suitable_map(look) : look.colour_map;
  static_cast<void>(colour_map(scale.colour_map));  // throws for an unknown name
  if (look.colour == CloudColour::kPlain) return scale;
  const auto in_unit = [&look](double value) {
    return look.colour == CloudColour::kElevation ? deg_from_rad(value) : value;
  };
  std::vector<float> shown;
  if (!look.least || !look.most) {
    shown.resize(drawn.size());
    for (std::size_t k = 0; k < drawn.size(); ++k) shown[k] = values.at(drawn[k]);
  }
  const auto share = [&shown](double of) {
    const auto value = static_cast<double>(percentile(shown, of));
    return std::isfinite(value) ? value : 0.0;  // without any value every point has the colour of the unknown
  };
  const bool from_zero = look.colour == CloudColour::kDistance;
  scale.least = look.least ? in_unit(*look.least) : from_zero ? 0.0 : share(kLowShare);
  scale.most = look.most ? in_unit(*look.most) : share(kHighShare);
  if (look.least && look.most && !(scale.least < scale.most)) {
    throw ConfigError(fmt::format("the colours' least value {} is not below their most {}", scale.least, scale.most));
  }
  if (!(scale.least < scale.most)) {  // a single value, or none
    if (!look.least && !look.most && !from_zero) scale.least -= 0.5;
    if (look.most) scale.least = scale.most - 1.0;
    if (!look.most) scale.most = scale.least + 1.0;
  }
  return scale;
}

Colour colour_at(const ColourScale& scale, const ColourMap& map, float value) {
  return map.at((static_cast<double>(value) - scale.least) / (scale.most - scale.least));
}

Colour plain_colour(const CloudLook& look) { return look.is_dark ? colour_for(0xc9ccd1) : colour_for(0x59616b); }

std::vector<Colour> point_colours(std::span<const CloudPoint> cloud, const CloudLook& look,
                                  std::span<const float> distances_m) {
  const CloudValues values(look.colour, cloud, distances_m);
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0U);
  const ColourScale scale = colour_scale(look, values, all);
  const ColourMap& map = colour_map(scale.colour_map);
  std::vector<Colour> colours(cloud.size(), plain_colour(look));
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    if (const float value = values.at(k); std::isfinite(value)) colours[k] = colour_at(scale, map, value);
  }
  return colours;
}

std::vector<float> distances_to(std::span<const CloudPoint> cloud, std::span<const CloudPoint> reference,
                                double most_m) {
  Cloud places;
  std::copy_if(reference.begin(), reference.end(), std::back_inserter(places), is_finite);
  const Neighbours neighbours(places);
  std::vector<float> distances(cloud.size(), static_cast<float>(most_m));
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    if (!is_finite(cloud[k])) continue;
    const Point3 at = to_position(cloud[k]);
    const std::optional<std::uint32_t> nearest = neighbours.nearest(at, most_m);
    if (nearest) distances[k] = static_cast<float>((neighbours.point(*nearest) - at).norm());
  }
  return distances;
}

LevelSurfaces sampled_level_surfaces(std::span<const CloudPoint> cloud) {
  Cloud sample;
  const std::size_t step = std::max<std::size_t>(1, (cloud.size() + kLevelSample - 1) / kLevelSample);
  sample.reserve(cloud.size() / step + 1);
  for (std::size_t k = 0; k < cloud.size(); k += step) {
    if (is_finite(cloud[k])) sample.push_back(cloud[k]);
  }
  return find_level_surfaces(sample, {});
}

double height_m(const Plane& plane, const Point2& at) {
  return (plane.offset_m - plane.normal.x() * at.x() - plane.normal.y() * at.y()) / plane.normal.z();
}

std::vector<std::uint32_t> drawn_points(std::span<const CloudPoint> cloud, const LevelSurfaces& surfaces,
                                        const CloudLook& look) {
  std::vector<std::uint32_t> drawn;
  drawn.reserve(cloud.size());
  bool has_any = false;
  for (std::uint32_t k = 0; k < cloud.size(); ++k) {
    if (!is_finite(cloud[k])) continue;
    has_any = true;
    const Point3 place = to_position(cloud[k]);
    if (!look.with_floor && surfaces.floor && surfaces.floor->plane.distance_m(place) <= kFloorMargin_m) continue;
    if (!look.with_ceiling && surfaces.ceiling && surfaces.ceiling->plane.distance_m(place) >= -kCeilingMargin_m) {
      continue;
    }
    drawn.push_back(k);
  }
  if (!has_any) throw InputError("the cloud has no points to show");
  if (drawn.empty()) throw InputError("the cloud is nothing but floor and ceiling; draw it with them");
  return drawn;
}

Bounds robust_bounds(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) {
  Bounds bounds;
  std::vector<float> along(drawn.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const CloudPoint& point = cloud[drawn[k]];
      along[k] = axis == 0 ? point.x_m : axis == 1 ? point.y_m : point.z_m;
    }
    bounds.lowest[axis] = static_cast<double>(percentile(along, kStrayLevelShare));
    bounds.highest[axis] = static_cast<double>(percentile(along, 1.0 - kStrayLevelShare));
  }
  return bounds;
}

std::uint64_t CloudDensity::cube_key(const CloudPoint& point) const {
  return cube_index(point.x_m, cube_m_) << (2 * kBits) | cube_index(point.y_m, cube_m_) << kBits |
         cube_index(point.z_m, cube_m_);
}

CloudDensity::CloudDensity(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double cube_m)
    : cube_m_(cube_m) {
  for (const std::uint32_t k : drawn) ++counts_[cube_key(cloud[k])];
}

float CloudDensity::spacing_m(const CloudPoint& point) const {
  const auto cube = counts_.find(cube_key(point));
  return static_cast<float>(cube_m_ / std::sqrt(static_cast<double>(cube == counts_.end() ? 1U : cube->second)));
}

CloudGaps::CloudGaps(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double longest_side_m) {
  const std::size_t step = std::max<std::size_t>(1, drawn.size() / kDensitySample);
  for (double cube_m = std::max(kLeastCube_m, longest_side_m / kCubesAlong);; cube_m *= 2.0) {
    density_.emplace(cloud, drawn, cube_m);
    std::vector<float> gaps;
    for (std::size_t k = 0; k < drawn.size(); k += step) gaps.push_back(density_->spacing_m(cloud[drawn[k]]));
    const auto median_m = static_cast<double>(percentile(gaps, 0.5));
    largest_m_ = std::max(kLargestGap_m, kGapsPerMedian * median_m);
    if (median_m * kGapsPerCube <= cube_m || cube_m * kCoarsestCubesAlong > longest_side_m) return;
  }
}

bool CloudGaps::is_alone(const CloudPoint& point) const {
  return static_cast<double>(density_->spacing_m(point)) > largest_m_;
}

double CloudGaps::at_m(const CloudPoint& point) const {
  return std::min(static_cast<double>(density_->spacing_m(point)), largest_m_);
}

}  // namespace gdtslam
