// Colours between two colours. Constant time.
#pragma once

#include <cmath>
#include <cstdint>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam::picture {

inline std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share) {
  return static_cast<std::uint8_t>(std::floor(from + share * (static_cast<double>(to) - from) + 0.5));
}

/// Share 0 gives the first, 1 the second.
inline Colour mixed(Colour from, Colour to, double share) {
  return {mixed(from.red, to.red, share), mixed(from.green, to.green, share), mixed(from.blue, to.blue, share)};
}

}  // namespace gdtslam::picture
