#include "cloud_colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "engine/cloud/neighbours.hpp"
#include "engine/cloud/to_position.hpp"
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

// Sequential, the least value nearest to the background, so that what is high, late or far off stands out.
const char* suitable_map(const CloudLook& look) { return look.is_dark ? "lagoon" : "tide"; }

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
  static_cast<void>(colour_map(scale.colour_map));  // throws where there is none of the name
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
    return std::isfinite(value) ? value : 0.0;  // no value at all: every point has the colour of the unknown
  };
  const bool from_zero = look.colour == CloudColour::kDistance;
  scale.least = look.least ? in_unit(*look.least) : from_zero ? 0.0 : share(kLowShare);
  scale.most = look.most ? in_unit(*look.most) : share(kHighShare);
  if (look.least && look.most && !(scale.least < scale.most)) {
    throw ConfigError(fmt::format("the colours' least value {} is not below their most {}", scale.least, scale.most));
  }
  if (!(scale.least < scale.most)) {  // all of one value, or none
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

}  // namespace gdtslam
