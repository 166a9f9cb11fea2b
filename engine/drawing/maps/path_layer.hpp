// The path of the robot over a map: coloured by time, with keyframes, doubtful scans, start and end. Colours go from
// blue to orange with rising lightness, so that colour-blind readers see the order too. Doubtful scans are rings, black
// in white over a map and white in black over a field: no path has these colours, and they survive a print in grey.
// Thread-safe; O(poses).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// Colours of overlays on a light map or a dark field.
struct PathColours {
  std::vector<Colour> time;  ///< from start to end, evenly spaced
  Colour halo;
  Colour ink;  ///< keyframes mix it with their path's colour
  Colour doubtful;
};
/// Uses the named colour map for the time, if any.
PathColours path_colours(bool is_dark, const std::string& colour_map = "");
/// Interpolates two channels or colours: share 0 gives the first, 1 the second.
std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share);
Colour mixed(Colour from, Colour to, double share);
/// 0 at the start, 1 at the end.
Colour time_colour(const PathColours& colours, double share);

/// Throws InputError if an index is beyond a trajectory of `count` poses; `what` names it.
void check_index(std::size_t index, std::size_t count, const char* what);
void check(const PathOverlay& overlay);

/// The time since the start, as share of the whole, of each pose; monotonic even if stamps of a log are not.
std::vector<double> time_shares(const Trajectory& trajectory);

/// A pose that is drawn.
struct SeenPose {
  Point2 at;
  std::size_t index = 0;
};
/// Poses from `begin` to before `end` on the page; a pose not visibly apart from the last one is skipped, so a standing
/// robot costs nothing.
std::vector<SeenPose> seen_poses(const MapFrame& frame, const Trajectory& trajectory, std::size_t begin,
                                 std::size_t end, double least_px);
/// Dots at poses; overlapping dots are merged.
void draw_dots(Canvas& canvas, const MapFrame& frame, const Trajectory& trajectory,
               const std::vector<std::size_t>& indices, double radius,
               const std::function<Colour(std::size_t)>& dot_colour);

/// A path with a value at each pose, as share of a scale; NaN: no value. Without values all are 0.
struct PathOfValues {
  const Trajectory& trajectory;
  const std::vector<std::size_t>& drives;
  const std::vector<double>& shares;
};
/// Width of a line and its border.
struct ValueLine {
  std::optional<Colour> halo;
  double width_px = 2.4;
};
/// `colour_at` receives a share, or NaN if there is no value.
void draw_line_of_values(Canvas& canvas, const MapFrame& frame, const PathOfValues& path,
                         const std::function<Colour(double)>& colour_at, const ValueLine& line);

/// The path in the requested look. Overlay, look and colours must outlive the layer.
MapLayer path_layer(const PathOverlay& overlay, const MapLook& look, const PathColours& colours);
/// A line of one colour, `widths` times as wide as a path, with a legend entry.
MapLayer line_layer(const Trajectory& path, const std::vector<std::size_t>& drives, const std::string& words,
                    Colour colour, const ValueLine& line);

}  // namespace gdtslam::picture
