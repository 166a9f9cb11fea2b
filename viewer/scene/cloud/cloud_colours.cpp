#include "cloud_colours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

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
Meaning meaning_of(CloudColour colour) {
  switch (colour) {
    case CloudColour::kHeight:
      return {"Height", "m"};
    case CloudColour::kElevation:
      return {"Elevation", "°"};
    case CloudColour::kTime:
      return {"Time", "s"};
    case CloudColour::kScan:
      return {"Scan", ""};
    case CloudColour::kDistance:
      return {"Distance", "m"};
    case CloudColour::kPlain:
      break;
  }
  return {"", ""};
}

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

float percentile(std::vector<float>& values, double share) {
  const auto end = std::partition(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  const auto count = static_cast<double>(end - values.begin());
  if (count < 1.0) return std::numeric_limits<float>::quiet_NaN();
  const auto rank = static_cast<std::ptrdiff_t>(std::floor(share * (count - 1.0) + 0.5));
  std::nth_element(values.begin(), values.begin() + rank, end);
  return values[static_cast<std::size_t>(rank)];
}

ColourScale colour_scale(const CloudLook& look, const CloudValues& values, std::span<const std::uint32_t> drawn) {
  const Meaning meaning = meaning_of(look.colour);
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

}  // namespace gdtslam
