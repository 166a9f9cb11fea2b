// Figure 3: distances as numbers in cells.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cell_image.hpp"
#include "cell_number.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr std::int32_t kMostCells = 60;

void check_part(const FieldPicture& field, const CellBox& part) {
  const GridGeometry& geometry = field.geometry;
  const std::string box = fmt::format("cells {}..{} by {}..{}", part.min.x, part.end.x - 1, part.min.y, part.end.y - 1);
  if (part.empty() || !geometry.contains(part.min) || !geometry.contains({part.end.x - 1, part.end.y - 1})) {
    throw InputError(
        fmt::format("{} are no part of the field, which has {} x {} cells", box, geometry.width, geometry.height));
  }
  if (part.width() > kMostCells || part.height() > kMostCells) {
    throw InputError(fmt::format("{} are too many to be read: at most {} a side", box, kMostCells));
  }
}

/// What the cells have in common: colours from 0 to the largest distance of the part, so that a small part uses all of
/// them, and one size for all numbers.
struct CellLook {
  const FieldPicture& field;
  CellBox part;
  bool is_squared = false;
  const ColourMap& map;
  double most = 1.0;
  double text_share = 0.42;  ///< of a cell's side
  bool has_obstacle = false;
  bool has_unknown = false;
  bool has_tenths = false;  ///< of one number, and so of all
  [[nodiscard]] CellNumber number(CellIndex cell) const {
    const std::size_t index = static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(field.geometry.width) +
                              static_cast<std::size_t>(cell.x);
    return cell_number(field.cells[index], field.cap, is_squared);
  }
  [[nodiscard]] Colour ground_of(const CellNumber& number) const {
    constexpr double kDarkest = 0.12;  // darker ones are too near to an obstacle's
    if (number.is_obstacle) return kLightTheme.text;
    return number.is_known ? map.at(kDarkest + (1.0 - kDarkest) * number.distance / most) : kLightTheme.grid;
  }
};

template <class Visit>
void for_each_cell(const CellBox& part, const Visit& visit) {
  for (std::int32_t y = part.min.y; y < part.end.y; ++y) {
    for (std::int32_t x = part.min.x; x < part.end.x; ++x) visit(CellIndex{x, y});
  }
}

CellLook look_of(const FieldPicture& field, const CellBox& part, bool is_squared, const MapLook& look) {
  CellLook cells{field, part, is_squared, colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map)};
  double widest = 0.42;         // of a cell, for a letter size of 1
  double widest_tenths = 0.42;  // likewise, of numbers with a decimal
  for_each_cell(part, [&](CellIndex cell) {
    const CellNumber number = cells.number(cell);
    if (number.is_known) cells.most = std::max(cells.most, number.distance);
    cells.has_obstacle = cells.has_obstacle || number.is_obstacle;
    cells.has_unknown = cells.has_unknown || !number.is_known;
    cells.has_tenths = cells.has_tenths || !number.is_whole;
    widest = std::max(widest, text_width(number.text, 1.0));
    widest_tenths = std::max(widest_tenths, text_width(number.text_tenths, 1.0));
  });
  cells.text_share = std::min(0.42, 0.8 / (cells.has_tenths ? widest_tenths : widest));
  return cells;
}

/// Every fifth row and column with its number in the field, left of the cells and below.
void draw_indices(Canvas& canvas, const MapFrame& frame, const CellLook& look) {
  const GridGeometry& grid = look.field.geometry;
  const double side = grid.resolution_m * frame.px_per_m;
  const int step = std::max(look.part.width(), look.part.height()) > 12 ? 5 : 1;
  const Lettering letters{.size = 0.34 * side, .colour = kLightTheme.quiet, .anchor = Anchor::kMiddle};
  const auto write = [&](CellIndex cell, std::int32_t index) {
    if (index % step != 0) return;
    canvas.text(frame.pixel_of(grid.centre_of(cell)) + Point2(0.0, 0.36 * letters.size), std::to_string(index),
                letters);
  };
  for (std::int32_t x = look.part.min.x; x < look.part.end.x; ++x) write({x, look.part.min.y - 1}, x);
  for (std::int32_t y = look.part.min.y; y < look.part.end.y; ++y) write({look.part.min.x - 1, y}, y);
}

void draw_number_cells(Canvas& canvas, const MapFrame& frame, const CellLook& look) {
  const GridGeometry& grid = look.field.geometry;
  const double side = grid.resolution_m * frame.px_per_m;
  const double size = look.text_share * side;
  for_each_cell(look.part, [&](CellIndex cell) {
    const CellNumber number = look.number(cell);
    const Colour ground = look.ground_of(number);
    const Point2 middle = frame.pixel_of(grid.centre_of(cell));
    canvas.rectangle(middle - 0.5 * Point2(side, side), side, side, Fill{ground},
                     Pen{.colour = kLightTheme.card, .width = 1.0});
    canvas.text(middle + Point2(0.0, 0.36 * size), look.has_tenths ? number.text_tenths : number.text,
                {.size = size, .colour = legible_on(ground), .anchor = Anchor::kMiddle});
  });
  draw_indices(canvas, frame, look);
}

LegendItems cell_items(const CellLook& look, const LegendLook& legend) {
  LegendItems items;
  if (look.has_obstacle) items.push_back(swatch_item("obstacle", kLightTheme.text, legend));
  if (look.has_unknown) {
    const std::string words = fmt::format("{:g} cells or more, or unknown", look.field.cap / 256.0);
    items.push_back(swatch_item(words, kLightTheme.grid, legend));
  }
  const char* const unit = look.is_squared ? "squared distance in cells²" : "distance in cells";
  items.push_back(swatch_item(unit, look.map.at(0.6), legend));
  return items;
}

/// Enough pixels for numbers that can be read.
PictureSize size_of_cells(const CellBox& part) {
  constexpr double kLeast_px = 44.0;
  constexpr double kMost_px = 64.0;
  const double cell_px = std::clamp(1100.0 / std::max(part.width(), part.height()), kLeast_px, kMost_px);
  return {static_cast<std::uint32_t>(std::max(700.0, cell_px * (part.width() + 1) + 120.0)),
          static_cast<std::uint32_t>(cell_px * (part.height() + 1) + 280.0)};
}

}  // namespace

Canvas cells_picture(const FieldPicture& field, const CellBox& part, bool is_squared, const MapLook& look) {
  check(field);
  check_part(field, part);
  const CellLook cells = look_of(field, part, is_squared, look);
  const CellBox with_indices{{part.min.x - 1, part.min.y - 1}, part.end};
  const MapLayer layer{[&](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
                         draw_number_cells(canvas, frame, cells);
                       },
                       [&](const LegendLook& legend, double /*px_per_m*/) { return cell_items(cells, legend); }};
  return drawn({"Distance transform", area_of(field.geometry, with_indices), kLightTheme, {layer}}, look,
               size_of_cells(part));
}

}  // namespace gdtslam
