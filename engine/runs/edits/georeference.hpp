// Where a map lies in the grid of a country or a site, from points that are known in both: the rigid motion that is
// best in least squares, in closed form for the plane [Umeyama1991], and the picture and world file for a GIS. Frames:
// map, and world (easting, northing), metres; doubles throughout, as eastings have seven digits before the point.
// Thread-safe; linear in the points.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// A point that is known in both frames.
struct PointPair {
  Point2 map_m;
  Point2 world_m;
  friend bool operator==(const PointPair&, const PointPair&) = default;
};

struct Georeference {
  Pose2 T_world_map;
  double scale = 1.0;                 ///< of the world by the map, as the points have it; the motion takes none
  double rms_m = 0.0;                 ///< of the residuals
  std::vector<double> residuals_m{};  ///< how far each point lies from where the motion puts it
};

/// Throws InputError with what to do where there are fewer than two points, where all lie within a metre in the map,
/// and where a residual is above 1 m and above 1 % of the points' extent: then they contradict each other.
Georeference fit_georeference(const std::vector<PointPair>& points);

inline constexpr const char* kMapPicture = "map.png";
inline constexpr const char* kWorldFile = "map.pgw";

/// map.png: a pixel a cell, occupied cells black, free ones white, unknown ones transparent; the top row first. Throws
/// FileError. O(cells), memory for a row.
void write_map_picture(const std::string& path, const OccupancyMap& map);

/// The six lines of an ESRI world file for the picture of a map, a pixel a cell, top row first: steps of a column
/// (east, north) and of a row, as the format orders them, and the centre of the upper left pixel; in the shortest form
/// that reads back as the same bits.
std::string world_file_text(const GridGeometry& map, const Pose2& T_world_map);

}  // namespace gdtslam
