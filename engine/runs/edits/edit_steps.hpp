// Regions of a map, and their removal from scans and from the occupancy map. Frame: the edited map. Thread-safe; linear
// in the corners.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// A closed polygon, in either sense of rotation; its last side need not be stated. If it crosses itself, points
/// surrounded an odd number of times are inside.
struct MapRegion {
  std::vector<Point2> corners_m;
  /// A point on a side that two regions share is inside exactly one of them.
  [[nodiscard]] bool contains(const Point2& point_m) const;
  friend bool operator==(const MapRegion&, const MapRegion&) = default;
};

/// The rectangle between two corners.
MapRegion rectangle_between(const Point2& low_m, const Point2& high_m);

/// The same region in frame a.
MapRegion in_frame(const Pose2& T_a_b, const MapRegion& region_b);

/// The corners with the least and the largest coordinates; the region has corners.
struct RegionBounds {
  Point2 low_m;
  Point2 high_m;
};
RegionBounds region_bounds(const MapRegion& region);

/// Regions in which readings may not end, and regions in which they must end.
struct EndRules {
  std::span<const MapRegion> erased{};
  std::span<const MapRegion> kept{};
};

/// Changes readings that violate the rules to no returns and returns their number; existing no returns stay. O(beams x
/// corners).
std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan);

/// The part of the map with all cells whose centres are in every region; its other cells are unknown. Without regions
/// the map itself. Throws InputError if nothing is left. O(cells).
OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept);

// Georeference of a map in the grid of a country or a site, from points known in both: the rigid motion with least
// squares, in closed form for the plane [Umeyama1991], and the picture and world file for a GIS. Frames: map, and world
// (easting, northing), metres; doubles throughout, as eastings have seven digits before the point. Thread-safe; linear
// in the points.

/// A point that is known in both frames.
struct PointPair {
  Point2 map_m;
  Point2 world_m;
  friend bool operator==(const PointPair&, const PointPair&) = default;
};

struct Georeference {
  Pose2 T_world_map;
  double scale = 1.0;                 ///< ratio of world to map by the points; the motion does not scale
  double rms_m = 0.0;                 ///< root mean square of the residuals
  std::vector<double> residuals_m{};  ///< distance of each point from its moved counterpart
};

/// Throws InputError with advice if there are fewer than two points, if all lie within a metre in the map, or if the
/// points contradict each other: a residual above 1 m and above 1 % of their extent.
Georeference fit_georeference(const std::vector<PointPair>& points);

inline constexpr const char* kMapPicture = "map.png";
inline constexpr const char* kWorldFile = "map.pgw";

/// map.png: one pixel for each cell, occupied black, free white, unknown transparent; the top row first. Throws
/// FileError. O(cells), memory for a row.
void write_map_picture(const std::string& path, const OccupancyMap& map);

/// The six lines of an ESRI world file for the picture of a map, one pixel for each cell, top row first: steps of a
/// column (east, north) and of a row in the format's order, and the centre of the upper left pixel; in the shortest
/// form that reads back as the same bits.
std::string world_file_text(const GridGeometry& map, const Pose2& T_world_map);

// The steps of an edited map with resolved numbers, their combined effect, and edits.json, which stores them so that
// they can be repeated (docs/formats.md). Frames: each step, with its regions and points, is in the frame of the map
// before it. Plain data; thread-safe; O(text).

/// In the folder of an edited run.
inline constexpr const char* kEditsFile = "edits.json";

/// Makes a pose of the map the origin of a new frame.
struct FrameEdit {
  enum class By : std::uint8_t { kStated, kWalls, kNorth };
  By by = By::kStated;       ///< source of the direction
  Pose2 T_before_after{};    ///< the new origin
  double walls_share = 0.0;  ///< WallDirection::share, if the direction is from walls
};
/// Removes readings that end in the region.
struct EraseEdit {
  MapRegion region;
};
/// Leaves out everything outside of the region.
struct CropEdit {
  Point2 low_m;
  Point2 high_m;
};
/// Places the map in the world, by points.
struct GeoreferenceEdit {
  std::vector<PointPair> points;
  Georeference fit;
};
/// Writes map.png and map.pgw.
struct WorldFileEdit {};

using EditStep = std::variant<FrameEdit, EraseEdit, CropEdit, GeoreferenceEdit, WorldFileEdit>;

/// The combined effect of steps. Regions and T_world_map are in the frame after the last step.
struct EditPlan {
  Pose2 T_edited_run{};
  bool has_other_frame = false;
  std::vector<MapRegion> erased;
  std::vector<MapRegion> kept;  ///< only points in all of them are kept
  std::optional<Pose2> T_world_edited;
  bool with_world_file = false;
};

/// Continues from the combined effect of earlier steps, without their regions, which have been applied.
EditPlan combine_steps(const std::vector<EditStep>& steps, const EditPlan& earlier = {});

struct RecordedEdits {
  std::string run;              ///< the edited folder, as given
  double begins_at_s = 0.0;     ///< stamp of the first pose of the run, which identifies its frame
  std::vector<EditStep> steps;  ///< all steps since the run of `map` or `merge`
};

/// `readings`: number of readings removed by the last edit.
std::string edits_text(const RecordedEdits& edits, std::size_t readings);

/// `name` is for messages. Throws InputError with the wrong step and what to do.
RecordedEdits parse_edits(std::string_view text, const std::string& name);
/// Also throws FileError.
RecordedEdits read_edits(const std::string& file);

}  // namespace gdtslam
