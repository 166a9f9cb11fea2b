// Values, colours, level surfaces and density of a cloud's points: each point's value, the scale's ends, the colour of
// a value, floor and ceiling, the points drawn without them, and the gaps between points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// The value that colours point k: m, degrees, s since `first_s`, scans, m; not a number if it has none.
class CloudValues {
 public:
  CloudValues(CloudColour colour, std::span<const CloudPoint> cloud, std::span<const float> distances_m);
  [[nodiscard]] float at(std::size_t k) const;

 private:
  CloudColour colour_;
  std::span<const CloudPoint> cloud_;
  std::span<const float> distances_m_;
  double first_s_ = 0.0;
};

/// Quantile of the finite values, at rank round(share * (n - 1)); not a number if none is finite. Reorders the values.
/// O(n).
template <class Value>
Value percentile(std::vector<Value>& values, double share) {
  const auto end = std::partition(values.begin(), values.end(), [](Value value) { return std::isfinite(value); });
  const auto count = static_cast<double>(end - values.begin());
  if (count < 1.0) return std::numeric_limits<Value>::quiet_NaN();
  const auto rank = static_cast<std::ptrdiff_t>(std::floor(share * (count - 1.0) + 0.5));
  std::nth_element(values.begin(), values.begin() + rank, end);
  return values[static_cast<std::size_t>(rank)];
}

/// Ends of the scale: from the look, else the 1st and 99th percentile of the drawn points' values (distances begin at
/// 0). If both are equal, the scale is 1 unit wide about them, or above them for distances. Throws ConfigError if the
/// least is not below the most, or the colour map is unknown.
ColourScale colour_scale(const CloudLook& look, const CloudValues& values, std::span<const std::uint32_t> drawn);

/// The look's values are in rad, the scale's in degrees.
Colour colour_at(const ColourScale& scale, const ColourMap& map, float value);
/// Colour of points without a value: CloudColour::kPlain.
Colour plain_colour(const CloudLook& look);
/// The colours of a cloud's points in its pictures, for writers of the points. `distances_m` is for
/// CloudColour::kDistance. Throws ConfigError like CloudScene. O(n).
std::vector<Colour> point_colours(std::span<const CloudPoint> cloud, const CloudLook& look,
                                  std::span<const float> distances_m = {});

/// Margins of level surfaces. Above the floor it is thicker than the floor's noise and thinner than objects on it;
/// below the ceiling it includes the lamps.
inline constexpr double kFloorMargin_m = 0.06;
inline constexpr double kCeilingMargin_m = 0.25;

/// Uses at most a quarter million points spread over the cloud. O(points).
LevelSurfaces sampled_level_surfaces(std::span<const CloudPoint> cloud);
/// Height of a level plane at a position in the map.
double height_m(const Plane& plane, const Point2& at);
/// Indices of the finite points that the look does not hide as floor (and below) or ceiling (and above). Throws
/// InputError if no point of the cloud is finite.
std::vector<std::uint32_t> drawn_points(std::span<const CloudPoint> cloud, const LevelSurfaces& surfaces,
                                        const CloudLook& look);
/// The box of the drawn points without 0.1 % at each end of each axis.
Bounds robust_bounds(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn);

/// Local distances between the points of a cloud: points are counted in cubes, and a surface through a cube shares its
/// area among them. Some 40 bytes a cube; O(points).
class CloudDensity {
 public:
  CloudDensity(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double cube_m);
  /// Mean distance between neighbours around a point of the cloud, metres; at most the cube's edge.
  [[nodiscard]] float spacing_m(const CloudPoint& point) const;

 private:
  [[nodiscard]] std::uint64_t cube_key(const CloudPoint& point) const;

  double cube_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> counts_;
};

/// The gaps that the points' discs should close: the spacing around each point, measured in cubes with several points.
/// It is limited to a little above the cloud's usual spacing; more isolated points stay visibly alone.
class CloudGaps {
 public:
  CloudGaps(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double longest_side_m);
  [[nodiscard]] double at_m(const CloudPoint& point) const;
  [[nodiscard]] bool is_alone(const CloudPoint& point) const;

 private:
  std::optional<CloudDensity> density_;
  double largest_m_ = 0.0;
};

}  // namespace gdtslam
