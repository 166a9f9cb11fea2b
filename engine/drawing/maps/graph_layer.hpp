// Layers with the graph of a run: loops, ellipses of uncertainty, doubtful stretches. Pixels. Thread-safe; O(poses +
// loops).
#pragma once

#include <string>

#include "gdtslam/drawing/canvas.hpp"
#include "graph_picture.hpp"
#include "map_frame.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// Throws InputError if an index of the overlay is beyond the trajectory, or the covariances are not its own.
void check(const GraphOverlay& overlay);

/// Of the path and its places.
inline constexpr Colour kPathInk = colour_for(0x3b4552);
inline constexpr double kPathPx = 1.7;
/// The factor by which ellipses of a standard deviation up to this one are enlarged: 1, 2 or 5 times a power of ten.
double ellipse_factor(double sigma_m, double px_per_m, const Proportions& sizes);
/// Three standard deviations of a position, `px_per_m` being the enlarged scale; nothing if it is not finite.
void draw_ellipse(Canvas& canvas, const Point2& centre, const PoseCovariance& covariance, double px_per_m,
                  const Proportions& sizes);
/// A loop that holds in the colour of its weight, one that does not dashed.
void draw_loop(Canvas& canvas, const Point2& from, const Point2& to, double weight, bool is_on,
               const Proportions& sizes);

/// A ring with words about ellipses; `every` is empty or " every 5 m".
LegendItem ellipse_item(const std::string& every, double factor, const LegendLook& look);
/// A bar of the colours of weights, from 0.25 to 1, after words; and a mark of what is switched off before them.
LegendItem loops_on_item(const std::string& words, const LegendLook& look);
LegendItem loops_off_item(const std::string& words, const LegendLook& look);

/// Stretches, path with keyframes, ellipses, loops and pins. The overlay must outlive the layer.
MapLayer graph_layer(const GraphOverlay& overlay);

}  // namespace gdtslam::picture
