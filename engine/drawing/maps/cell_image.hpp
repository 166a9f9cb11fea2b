// The cells of a map or a field as an image: one pixel per cell if the picture has more pixels than cells (shown as
// squares), else each pixel combines its cells so that no thin wall is lost. Thread-safe; O(cells + pixels).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "gdtslam/core/grids.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {

/// An image and its position in the picture.
struct PlacedImage {
  Panel at;
  std::shared_ptr<const RgbaImage> image;
};
void draw(Canvas& canvas, const PlacedImage& placed);

struct MapColours {
  Colour wall;
  Colour free;
  Colour unknown;
};
/// Unknown cells are transparent.
PlacedImage occupancy_image(const OccupancyMap& map, const MapFrame& frame, const MapColours& colours);
/// Layer with the cells of a map on a page of the unknown's colour; the legend explains walls. The map must outlive it.
MapLayer wall_layer(const OccupancyMap& map, const MapColours& colours);

/// Colour and opacity of a value of the field.
struct CellColour {
  Colour colour;
  std::uint8_t alpha = 255;
};
using FieldColours = std::function<CellColour(std::uint16_t)>;
/// Throws InputError if the field has too few cells or cap 0; every picture of a field relies on it.
void check(const FieldPicture& field);
/// A pixel shows the least distance of the cells with centres in it.
PlacedImage field_image(const FieldPicture& field, const MapFrame& frame, const FieldColours& colours);

}  // namespace gdtslam::picture
