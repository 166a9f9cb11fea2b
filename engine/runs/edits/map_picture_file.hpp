// map.png of a georeferenced map: a pixel a cell, for a GIS. Thread-safe; O(cells), memory for a row.
#pragma once

#include <string>
#include <string_view>

#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

inline constexpr const char* kMapPicture = "map.png";
inline constexpr const char* kWorldFile = "map.pgw";
inline bool is_map_for_gis(std::string_view name) { return name == kMapPicture || name == kWorldFile; }

/// Occupied cells black, free ones white, unknown ones transparent; the top row first. Throws FileError.
void write_map_picture(const std::string& path, const OccupancyMap& map);

}  // namespace gdtslam
