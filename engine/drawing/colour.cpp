#include "gdtslam/drawing/colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

std::string hex_text(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

ColourMap::ColourMap(std::string_view name, std::string_view doc, std::vector<Colour> table, Colour unknown)
    : name_(name), doc_(doc), table_(std::move(table)), unknown_(unknown) {}

Colour ColourMap::at(double share) const {
  if (std::isnan(share)) return unknown_;
  return table_[static_cast<std::size_t>(
      std::floor(std::clamp(share, 0.0, 1.0) * static_cast<double>(table_.size() - 1) + 0.5))];
}

const ColourMap& colour_map(std::string_view name) {
  std::string names;
  for (const ColourMap& map : colour_maps()) {
    if (map.name() == name) return map;
    names += (names.empty() ? "" : ", ") + std::string(map.name());
  }
  throw ConfigError(fmt::format("there is no colour map '{}': there are {}", name, names));
}

}  // namespace gdtslam
