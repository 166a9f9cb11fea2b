// A region of a map by the corners of its outline, and what is taken out of scans and of the occupancy map by regions.
// Frame: the edited map. Thread-safe; linear in the corners.
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

/// A polygon without its last side said, in either sense of rotation; where it crosses itself, what is surrounded an
/// odd number of times is inside.
struct MapRegion {
  std::vector<Point2> corners_m;
  /// A point on the outline is inside on one of two regions that share that side.
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

/// Regions in which readings may not end, and regions in which they have to.
struct EndRules {
  std::span<const MapRegion> erased{};
  std::span<const MapRegion> kept{};
};

/// Makes readings that end where they must not no returns, and tells how many; ranges that are no return stay.
/// O(beams x corners).
std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan);

/// The part of the map that holds all cells whose centres are in every region, the others in it unknown; the map itself
/// where there are no regions. Throws InputError where nothing is left. O(cells).
OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept);

// Place of a map in the grid of a country or a site, from points that are known in both: the rigid motion that is
// best in least squares, in closed form for the plane [Umeyama1991], and the picture and world file for a GIS. Frames:
// map, and world (easting, northing), metres; doubles throughout, as eastings have seven digits before the point.
// Thread-safe; linear in the points.

/// A point that is known in both frames.
struct PointPair {
  Point2 map_m;
  Point2 world_m;
  friend bool operator==(const PointPair&, const PointPair&) = default;
};

struct Georeference {
  Pose2 T_world_map;
  double scale = 1.0;                 ///< ratio of world to map, by the points; the motion has none
  double rms_m = 0.0;                 ///< root mean square of the residuals
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

// The steps of an edited map, with their numbers as resolved, what they come to, and edits.json, which has them so that
// they can be done again (docs/formats.md). Frames: each step is in the frame of the map before it, and so are its
// regions and points. Plain data; thread-safe; O(text).

/// In the folder of an edited run.
inline constexpr const char* kEditsFile = "edits.json";

/// A pose of the map becomes the origin of a new frame.
struct FrameEdit {
  enum class By : std::uint8_t { kStated, kWalls, kNorth };
  By by = By::kStated;       ///< source of the direction
  Pose2 T_before_after{};    ///< the new origin
  double walls_share = 0.0;  ///< WallDirection::share, where walls gave it
};
/// Readings that end there are taken out.
struct EraseEdit {
  MapRegion region;
};
/// The rest is left out.
struct CropEdit {
  Point2 low_m;
  Point2 high_m;
};
/// The place of the map in the world, from points.
struct GeoreferenceEdit {
  std::vector<PointPair> points;
  Georeference fit;
};
/// map.png and map.pgw are written.
struct WorldFileEdit {};

using EditStep = std::variant<FrameEdit, EraseEdit, CropEdit, GeoreferenceEdit, WorldFileEdit>;

/// The combined effect of steps. Regions and T_world_map are in the frame after the last step.
struct EditPlan {
  Pose2 T_edited_run{};
  bool has_other_frame = false;
  std::vector<MapRegion> erased;
  std::vector<MapRegion> kept;  ///< everything outside of any of them is left out
  std::optional<Pose2> T_world_edited;
  bool with_world_file = false;
};

/// Goes on with what earlier steps came to, whose regions have been dealt with.
EditPlan combine_steps(const std::vector<EditStep>& steps, const EditPlan& earlier = {});

struct RecordedEdits {
  std::string run;              ///< the folder that was edited, as it was named
  double begins_at_s = 0.0;     ///< stamp of the first pose of the run: who has another has another frame
  std::vector<EditStep> steps;  ///< from the first edit of a run that `map` or `merge` wrote
};

/// `readings` were taken out by the last edit.
std::string edits_text(const RecordedEdits& edits, std::size_t readings);

/// `name` stands in messages. Throws InputError with the step that is wrong and what to do.
RecordedEdits parse_edits(std::string_view text, const std::string& name);
/// Throws FileError too.
RecordedEdits read_edits(const std::string& file);

}  // namespace gdtslam
