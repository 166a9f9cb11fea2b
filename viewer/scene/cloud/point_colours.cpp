#include "point_colours.hpp"

#include <cmath>
#include <numeric>

#include "cloud_colours.hpp"

namespace gdtslam {

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

}  // namespace gdtslam
