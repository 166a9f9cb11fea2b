// A map on a page: where its places lie there, and its obstacles in grey. Pixels, x of the map right, y up.
// Thread-safe; O(cells).
#pragma once

#include <span>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "gdtslam/io/distance_field_file.hpp"

namespace gdtslam {

namespace page_sizes {
inline constexpr double kWidth = 1180.0;
inline constexpr double kMargin = 24.0;
inline constexpr double kHeading = 62.0;
inline constexpr double kLegend = 46.0;
inline constexpr double kInset = 18.0;  ///< of the map in its card
}  // namespace page_sizes

/// From the map to the page.
struct MapView {
  DrawingArea card;
  Point2 centre_m = Point2::Zero();
  double pixels_per_m = 20.0;
  [[nodiscard]] Point2 at(const Point2& place_m) const {
    const Point2 off = pixels_per_m * (place_m - centre_m);
    return card.corner + Point2(0.5 * card.width + off.x(), 0.5 * card.height - off.y());
  }
  [[nodiscard]] Point2 back(const Point2& page) const {
    const Point2 off = page - card.corner - Point2(0.5 * card.width, 0.5 * card.height);
    return centre_m + Point2(off.x(), -off.y()) / pixels_per_m;
  }
};

/// All of the map but single returns far outside, and these places.
MapView view_of_map(const DistanceFieldView& field, std::span<const Point2> places_m);

void draw_walls(Canvas& canvas, const MapView& view, const DistanceFieldView& field);

}  // namespace gdtslam
