// The path of the robot over a map: coloured by time, with keyframes, doubtful scans, start and end. Blue to orange
// with rising lightness, so that readers who do not tell red from green see the order too; doubtful scans are rings,
// black in white over a map and white in black over a field: no palette of a path has these, nor a print without
// colours. Thread-safe; O(poses).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "map_frame.hpp"

namespace gdtslam::picture {

/// Colours of what lies over a light map or a dark field.
struct PathColours {
  std::vector<Colour> time;  ///< from start to end, evenly spaced
  Colour halo;
  Colour ink;  ///< keyframes take their path's colour, mixed with it
  Colour doubtful;
};
const PathColours& path_colours(bool is_dark);
/// The same with the time in the colours of a map.
PathColours path_colours(const ColourMap& map, bool is_dark);
/// Between two colours, or channels: share 0 gives the first, 1 the second.
std::uint8_t mixed(std::uint8_t from, std::uint8_t to, double share);
Colour mixed(Colour from, Colour to, double share);
/// 0 at the start, 1 at the end.
Colour time_colour(const PathColours& colours, double share);
Colour keyframe_colour(const PathColours& colours, double share);

/// A path of several drives in pieces: the index at which each begins, and behind the last one the count.
std::vector<std::size_t> ends_of_drives(const std::vector<std::size_t>& drives, std::size_t count);

/// Throws InputError where an index of the overlay is beyond the trajectory.
void check(const PathOverlay& overlay);
/// The time since the start, as share of the whole, of each pose; never falls, though stamps of some logs do.
std::vector<double> time_shares(const Trajectory& trajectory);
/// From the first to the latest stamp.
double duration_s(const Trajectory& trajectory);

void draw_path(Canvas& canvas, const MapFrame& frame, const PathOverlay& overlay, const MapLook& look,
               const PathColours& colours, const Proportions& sizes);

/// A path and a value at each of its poses, as share of a scale; what has no number has no value.
struct PathOfValues {
  const Trajectory& trajectory;
  const std::vector<std::size_t>& drives;
  const std::vector<double>& shares;
};
/// How wide, and what is around it.
struct ValueLine {
  Colour halo;
  double width_px = 2.4;
};
/// `colour_at` is asked with a share, or with no number where there is no value.
void draw_line_of_values(Canvas& canvas, const MapFrame& frame, const PathOfValues& path,
                         const std::function<Colour(double)>& colour_at, const ValueLine& line);

// What the legend shows of them, around `centre`.
void draw_start(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes);
void draw_end(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes);
void draw_keyframe(Canvas& canvas, const Point2& centre, Colour colour, const Proportions& sizes);
void draw_doubtful(Canvas& canvas, const Point2& centre, const PathColours& colours, const Proportions& sizes);

}  // namespace gdtslam::picture
