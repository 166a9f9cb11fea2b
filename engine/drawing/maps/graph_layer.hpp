// What of a graph lies over a map, and what its legend says of it. Pixels. Thread-safe; O(poses + loops).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "graph_picture.hpp"
#include "map_frame.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// Throws InputError where an index of the overlay is beyond the trajectory, or the covariances are not its own.
void check(const GraphOverlay& overlay);

/// How ellipses are drawn: every so many metres of path, so many times as large.
struct EllipseScale {
  double every_m = 0.0;  ///< nothing where there are none
  double factor = 1.0;   ///< 1, 2 or 5 times a power of ten
};
EllipseScale ellipse_scale(const GraphOverlay& overlay, double px_per_m, const Proportions& sizes);

/// Of the path and its places.
inline constexpr Colour kPathInk = colour_for(0x3b4552);
inline constexpr double kPathPx = 1.7;
inline constexpr double kNodePx = 2.3;
inline constexpr double kSigmas = 3.0;
/// The factor by which ellipses of a standard deviation up to this one are enlarged: 1, 2 or 5 times a power of ten.
double ellipse_factor(double sigma_m, double px_per_m, const Proportions& sizes);
/// Three standard deviations of a position, enlarged; nothing where it is not finite.
void draw_ellipse(Canvas& canvas, const Point2& centre, const PoseCovariance& covariance, double px_per_sigma,
                  const Proportions& sizes);
/// A loop that holds in the colour of its weight, one that does not dashed.
void draw_loop(Canvas& canvas, const Point2& from, const Point2& to, const LoopLine& loop, const Proportions& sizes);
bool is_on_sheet(const Point2& at);

/// Words after a mark that a function draws into the first `mark_px` of the item.
LegendItem graph_item(const std::string& words, double mark_px, const LegendLook& look,
                      std::function<void(Canvas&, const Point2&)> draw_mark);
/// A ring with words about ellipses.
LegendItem ellipse_item(const std::string& words, const LegendLook& look);
/// A bar of the colours of weights, from 0.25 to 1, after words; and a mark of what is switched off before them.
LegendItem loops_on_item(const std::string& words, const LegendLook& look);
LegendItem loops_off_item(const std::string& words, const LegendLook& look);

void draw_graph(Canvas& canvas, const MapFrame& frame, const GraphOverlay& overlay, const Proportions& sizes);

/// Those of what there is: keyframes, loops, ellipses, doubtful stretches.
void add_graph_items(std::vector<LegendItem>& items, const GraphOverlay& overlay, double px_per_m,
                     const LegendLook& look);

}  // namespace gdtslam::picture
