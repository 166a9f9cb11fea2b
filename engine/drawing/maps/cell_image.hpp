// The cells of a map or a field as an image for a frame: each cell one pixel where the picture has more pixels than
// cells (shown as squares), else each pixel from the cells under it, such that no thin wall is lost. Thread-safe;
// O(cells + pixels).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "map_frame.hpp"

namespace gdtslam::picture {

/// An image and where it lies in the picture.
struct PlacedImage {
  Panel at;
  std::shared_ptr<const RgbaImage> image;
};
/// What of it lies within the panel.
void draw(Canvas& canvas, const Panel& panel, const PlacedImage& placed);

struct MapColours {
  Colour wall;
  Colour free;
  Colour unknown;
  bool is_unknown_clear = false;  ///< unknown cells let the background through
};
PlacedImage occupancy_image(const OccupancyMap& map, const MapFrame& frame, const MapColours& colours);

/// Colour and opacity of a value of the field.
struct CellColour {
  Colour colour;
  std::uint8_t alpha = 255;
};
using FieldColours = std::function<CellColour(std::uint16_t)>;
/// What every picture of a field relies on: throws InputError where cells are missing or the cap says nothing.
void check(const FieldPicture& field);
/// A pixel shows the least distance of the cells whose centres lie under it.
PlacedImage field_image(const FieldPicture& field, const MapFrame& frame, const FieldColours& colours);

}  // namespace gdtslam::picture
