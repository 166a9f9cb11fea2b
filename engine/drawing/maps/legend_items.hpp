// What legends of maps consist of: scale bar, axes, the colours of time, marks with their number, colours of cells.
// Thread-safe; constant time.
#pragma once

#include <string>

#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// "45 s", "12 min 5 s", "3 h 12 min".
std::string duration_text(double seconds);

/// How a legend is lettered.
struct LegendLook {
  Theme theme;
  Proportions sizes;
};
LegendItem scale_bar_item(double px_per_m, const LegendLook& look);
/// x to the right, y up: north of the map's frame.
LegendItem axes_item(const LegendLook& look);
LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look);
/// A bar of colours between two words; `colour_at` takes a share.
LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look);
/// Those that the overlay asks for: time, keyframes, doubtful scans.
void add_path_items(std::vector<LegendItem>& items, const PathOverlay& overlay, const MapLook& look,
                    const PathColours& colours, const LegendLook& legend);

}  // namespace gdtslam::picture
