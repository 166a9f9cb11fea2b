// What the colours of a cloud's points mean: a value for each point, the scale's ends, and the colour of a value.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// The value that colours point k: m, degrees, s since `first_s`, scans, m; not a number where there is none.
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

/// The value below which that share of the finite values lies: the one of rank round(share * (n - 1)) in order; not a
/// number where none is finite. Changes the order of the values. O(n).
template <class Value>
Value percentile(std::vector<Value>& values, double share) {
  const auto end = std::partition(values.begin(), values.end(), [](Value value) { return std::isfinite(value); });
  const auto count = static_cast<double>(end - values.begin());
  if (count < 1.0) return std::numeric_limits<Value>::quiet_NaN();
  const auto rank = static_cast<std::ptrdiff_t>(std::floor(share * (count - 1.0) + 0.5));
  std::nth_element(values.begin(), values.begin() + rank, end);
  return values[static_cast<std::size_t>(rank)];
}

/// Ends of the scale: what the look asks for, else the 1st and 99th percentile of the values of the points that are
/// drawn (distances begin at 0). Where both are one value the scale is 1 unit wide about it, that of distances above
/// it. Throws ConfigError where the least is not below the most, or the colour map is unknown.
ColourScale colour_scale(const CloudLook& look, const CloudValues& values, std::span<const std::uint32_t> drawn);

/// The look's values are in rad, the scale's in degrees.
Colour colour_at(const ColourScale& scale, const ColourMap& map, float value);
/// Of points without a value: CloudColour::kPlain.
Colour plain_colour(const CloudLook& look);
/// The colours that a picture of a cloud gives its points, one for each, for who writes the points elsewhere.
/// `distances_m` belongs to CloudColour::kDistance. Throws ConfigError as CloudScene does. O(n).
std::vector<Colour> point_colours(std::span<const CloudPoint> cloud, const CloudLook& look,
                                  std::span<const float> distances_m = {});

}  // namespace gdtslam
