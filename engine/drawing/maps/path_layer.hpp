// The path of the robot over a map: coloured by time, with keyframes, doubtful scans, start and end. Blue to orange
// with rising lightness, so that readers who do not tell red from green see the order too; doubtful scans are rings,
// black in white over a map and white in black over a field: no palette of a path has these, nor a print without
// colours. Thread-safe; O(poses).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// Colours of what lies over a light map or a dark field.
struct PathColours {
  std::vector<Colour> time;  ///< from start to end, evenly spaced
  Colour halo;
  Colour ink;  ///< keyframes take their path's colour, mixed with it
  Colour doubtful;
};
/// With the time in the colours of a map, if it has a name.
PathColours path_colours(bool is_dark, const std::string& colour_map = "");
/// Between two colours, or channels: share 0 gives the first, 1 the second.
std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share);
Colour mixed(Colour from, Colour to, double share);
/// 0 at the start, 1 at the end.
Colour time_colour(const PathColours& colours, double share);

/// Throws InputError if an index is beyond a trajectory of `count` poses; `what` names it.
void check_index(std::size_t index, std::size_t count, const char* what);
void check(const PathOverlay& overlay);

/// The time since the start, as share of the whole, of each pose; never falls, though stamps of some logs do.
std::vector<double> time_shares(const Trajectory& trajectory);

/// A pose that is drawn.
struct SeenPose {
  Point2 at;
  std::size_t index = 0;
};
/// The poses from `begin` to before `end` on the page: none nearer to the last one than can be seen, so that a robot
/// that stands costs nothing.
std::vector<SeenPose> seen_poses(const MapFrame& frame, const Trajectory& trajectory, std::size_t begin,
                                 std::size_t end, double least_px);
/// Dots at poses; those that would hide each other are one.
void draw_dots(Canvas& canvas, const MapFrame& frame, const Trajectory& trajectory,
               const std::vector<std::size_t>& indices, double radius,
               const std::function<Colour(std::size_t)>& dot_colour);

/// A path and a value at each of its poses, as share of a scale; what has no number has no value. No values: all are 0.
struct PathOfValues {
  const Trajectory& trajectory;
  const std::vector<std::size_t>& drives;
  const std::vector<double>& shares;
};
/// How wide, and what is around it.
struct ValueLine {
  std::optional<Colour> halo;
  double width_px = 2.4;
};
/// `colour_at` is asked with a share, or with no number if there is no value.
void draw_line_of_values(Canvas& canvas, const MapFrame& frame, const PathOfValues& path,
                         const std::function<Colour(double)>& colour_at, const ValueLine& line);

/// The path as the look asks for it. Overlay, look and colours must outlive the layer.
MapLayer path_layer(const PathOverlay& overlay, const MapLook& look, const PathColours& colours);
/// A line of one colour, `widths` times as wide as a path, with words in the legend.
MapLayer line_layer(const Trajectory& path, const std::vector<std::size_t>& drives, const std::string& words,
                    Colour colour, const ValueLine& line);

}  // namespace gdtslam::picture
