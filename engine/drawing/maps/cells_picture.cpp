// Figure 3: distances as numbers in cells.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cell_image.hpp"
#include "cell_number.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_frame.hpp"
#include "map_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr std::int32_t kMostCells = 60;
constexpr double kBody = 15.0;
constexpr double kMargin = 28.0;

/// Where everything lies: a cell is large enough for its number, and a part of few cells is still a picture.
struct CellSheet {
  CellBox part;
  double cell_px = 40.0;
  Point2 corner;  ///< upper left of the upper left cell
  double width = 0.0;
  double height = 0.0;
  [[nodiscard]] Point2 corner_of(CellIndex cell) const {
    return {corner.x() + cell_px * (cell.x - part.min.x), corner.y() + cell_px * (part.end.y - 1 - cell.y)};
  }
};

CellSheet sheet_of(const CellBox& part, const MapLook& look) {
  constexpr double kLeastCell = 34.0;
  constexpr double kMostCell = 56.0;
  constexpr double kSheet = 900.0;
  constexpr double kLeastCellWidth = 480.0;  // what the legend needs
  constexpr double kIndexRoom = 26.0;
  CellSheet sheet;
  sheet.part = part;
  sheet.cell_px = std::clamp(std::floor(kSheet / std::max(part.width(), part.height())), kLeastCell, kMostCell);
  const double wide = sheet.cell_px * part.width();
  const double header = (look.title.empty() ? 0.0 : 34.0) + (look.subtitle.empty() ? 0.0 : 24.0);
  sheet.width = std::max(kLeastCellWidth, wide + 2.0 * kMargin + kIndexRoom);
  sheet.corner = {std::floor(0.5 * (sheet.width - wide + kIndexRoom)), kMargin + header};
  sheet.height = sheet.corner.y() + sheet.cell_px * part.height() + kIndexRoom + 3.2 * kBody + kMargin;
  return sheet;
}

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
  const ColourMap& map;
  double most = 1.0;
  double text_px = 15.0;
  bool has_obstacle = false;
  bool has_unknown = false;
  bool has_tenths = false;  ///< of one number, and so of all
  [[nodiscard]] const std::string& words_of(const CellNumber& number) const {
    return has_tenths ? number.text_tenths : number.text;
  }
  [[nodiscard]] Colour at(double distance) const {
    constexpr double kDarkest = 0.12;  // darker ones are too near to an obstacle's
    return map.at(kDarkest + (1.0 - kDarkest) * distance / most);
  }
};

CellNumber number_at(const FieldPicture& field, CellIndex cell, bool is_squared) {
  const std::size_t index = static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(field.geometry.width) +
                            static_cast<std::size_t>(cell.x);
  return cell_number(field.cells[index], field.cap, is_squared);
}

CellLook look_of(const FieldPicture& field, const CellSheet& sheet, bool is_squared, const MapLook& look) {
  CellLook cells{.map = colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map)};
  double widest = 0.42;         // of a cell, for a letter size of 1
  double widest_tenths = 0.42;  // likewise, of numbers with a decimal
  for (std::int32_t y = sheet.part.min.y; y < sheet.part.end.y; ++y) {
    for (std::int32_t x = sheet.part.min.x; x < sheet.part.end.x; ++x) {
      const CellNumber number = number_at(field, {x, y}, is_squared);
      if (number.is_known) cells.most = std::max(cells.most, number.distance);
      cells.has_obstacle = cells.has_obstacle || number.is_obstacle;
      cells.has_unknown = cells.has_unknown || !number.is_known;
      cells.has_tenths = cells.has_tenths || !number.is_whole;
      widest = std::max(widest, text_width(number.text, 1.0));
      widest_tenths = std::max(widest_tenths, text_width(number.text_tenths, 1.0));
    }
  }
  // Where cells are many, the sheet is made smaller, and what is left between two numbers tells them apart.
  constexpr std::int32_t kMany = 30;
  const double room = std::max(sheet.part.width(), sheet.part.height()) > kMany ? 0.74 : 0.86;
  cells.text_px = std::min(0.42, room / (cells.has_tenths ? widest_tenths : widest)) * sheet.cell_px;
  return cells;
}

void draw_cell(Canvas& canvas, const CellSheet& sheet, CellIndex cell, const CellNumber& number, const CellLook& look) {
  const Point2 corner = sheet.corner_of(cell);
  const Point2 middle = corner + Point2(0.5 * sheet.cell_px, 0.5 * sheet.cell_px);
  Colour ground = kLightTheme.grid;
  if (number.is_obstacle) ground = kLightTheme.text;
  if (number.is_known && !number.is_obstacle) ground = look.at(number.distance);
  canvas.rectangle(corner, sheet.cell_px, sheet.cell_px, Fill{ground}, Pen{.colour = kLightTheme.card, .width = 1.0});
  canvas.text({middle.x(), middle.y() + 0.36 * look.text_px}, look.words_of(number),
              {.size = look.text_px, .colour = legible_on(ground), .anchor = Anchor::kMiddle});
}

/// Every fifth row and column with its number in the field.
void draw_indices(Canvas& canvas, const CellSheet& sheet) {
  const Lettering letters{.size = 0.8 * kBody, .colour = kLightTheme.quiet, .anchor = Anchor::kMiddle};
  Lettering right = letters;
  right.anchor = Anchor::kEnd;
  const int step = std::max(sheet.part.width(), sheet.part.height()) > 12 ? 5 : 1;
  const double half = 0.5 * sheet.cell_px;
  for (std::int32_t x = sheet.part.min.x; x < sheet.part.end.x; ++x) {
    if (x % step != 0) continue;
    const Point2 corner = sheet.corner_of({x, sheet.part.min.y});
    canvas.text({corner.x() + half, corner.y() + sheet.cell_px + 1.2 * letters.size}, std::to_string(x), letters);
  }
  for (std::int32_t y = sheet.part.min.y; y < sheet.part.end.y; ++y) {
    if (y % step != 0) continue;
    const Point2 corner = sheet.corner_of({sheet.part.min.x, y});
    canvas.text({corner.x() - 0.6 * letters.size, corner.y() + half + 0.36 * letters.size}, std::to_string(y), right);
  }
}

void draw_legend(Canvas& canvas, const CellSheet& sheet, const CellLook& look, bool is_squared, double cap_cells) {
  const double y = sheet.height - kMargin - kBody;
  double x = kMargin;
  const auto swatch = [&](Colour colour, const std::string& words) {
    canvas.rectangle({x, y - 0.5 * kBody}, kBody, kBody, Fill{colour}, Pen{.colour = kLightTheme.quiet});
    canvas.text({x + 1.5 * kBody, y + 0.36 * kBody}, words, {.size = kBody});
    x += 1.5 * kBody + text_width(words, kBody) + 2.0 * kBody;
  };
  if (look.has_obstacle) swatch(kLightTheme.text, "obstacle");
  if (look.has_unknown) swatch(kLightTheme.grid, fmt::format("{:g} cells or more, or unknown", cap_cells));
  canvas.text(
      {kMargin, y + 2.0 * kBody},
      is_squared ? "Squared distance to the nearest obstacle, in cells²" : "Distance to the nearest obstacle, in cells",
      {.size = kBody, .colour = kLightTheme.quiet});
}

void draw_head(Canvas& canvas, const CellSheet& sheet, const MapLook& look) {
  const double room = sheet.width - 2.0 * kMargin;
  double y = kMargin + 12.0;
  if (!look.title.empty()) {
    const FittedWords words = fitted_words(look.title, 24.0, kBody, room, true);
    canvas.text({kMargin, y}, words.text, {.size = words.size_px, .is_bold = true});
    y += 26.0;
  }
  if (!look.subtitle.empty()) {
    const FittedWords words = fitted_words(look.subtitle, kBody, 0.7 * kBody, room, false);
    canvas.text({kMargin, y}, words.text, {.size = words.size_px, .colour = kLightTheme.quiet});
  }
}

}  // namespace

Canvas cells_picture(const FieldPicture& field, const CellBox& part, bool is_squared, const MapLook& look) {
  check(field);
  check_part(field, part);
  const CellSheet sheet = sheet_of(part, look);
  const CellLook cells = look_of(field, sheet, is_squared, look);
  Canvas canvas(sheet.width, sheet.height, look.title.empty() ? "Distance transform" : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, sheet.width, sheet.height, Fill{kLightTheme.page});
  for (std::int32_t y = part.min.y; y < part.end.y; ++y) {
    for (std::int32_t x = part.min.x; x < part.end.x; ++x) {
      draw_cell(canvas, sheet, {x, y}, number_at(field, {x, y}, is_squared), cells);
    }
  }
  draw_indices(canvas, sheet);
  draw_head(canvas, sheet, look);
  draw_legend(canvas, sheet, cells, is_squared, field.cap / 256.0);
  return canvas;
}

}  // namespace gdtslam
