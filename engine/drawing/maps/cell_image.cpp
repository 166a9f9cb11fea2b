#include "cell_image.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "path_layer.hpp"

namespace gdtslam::picture {
namespace {

/// From this many pixels per cell on, cells are squares; below it squares of unequal size would be visible.
constexpr double kSquaresFromPx = 2.0;
/// Least darkness of a pixel with a single occupied cell, however many cells it covers.
constexpr double kLoneCellDarkness = 0.5;

void put(RgbaImage& image, std::uint32_t x, std::uint32_t y, const CellColour& colour) {
  std::uint8_t* const pixel = image.at(x, y);
  pixel[0] = colour.colour.red;
  pixel[1] = colour.colour.green;
  pixel[2] = colour.colour.blue;
  pixel[3] = colour.alpha;
}

/// Cells under the pixels of one axis: pixel k spans `first + k * step` to one step more, in cells.
struct PixelAxis {
  double first = 0.0;
  double step = 1.0;
  std::int32_t cells = 0;
  std::uint32_t pixels = 0;
  [[nodiscard]] double begin(std::uint32_t pixel) const { return first + step * pixel; }
  /// `cell` as a valid index of the grid, or its end.
  [[nodiscard]] std::int32_t held(double cell) const {
    return static_cast<std::int32_t>(std::clamp(cell, 0.0, static_cast<double>(cells)));
  }
};

struct Axes {
  PixelAxis x;
  PixelAxis y;  ///< upwards: pixel 0 is the lowest row
};

Axes pixel_axes(const GridGeometry& geometry, const MapFrame& frame) {
  const double cell_m = geometry.resolution_m;
  const double step = 1.0 / (frame.px_per_m * cell_m);
  const double bottom_m = frame.y_m - frame.panel.height_px / frame.px_per_m;
  return {{(frame.x_m - geometry.origin_x_m) / cell_m, step, geometry.width,
           static_cast<std::uint32_t>(frame.panel.width_px)},
          {(bottom_m - geometry.origin_y_m) / cell_m, step, geometry.height,
           static_cast<std::uint32_t>(frame.panel.height_px)}};
}

/// Cells at least partly inside the panel.
CellBox shown_cells(const Axes& axes) {
  return {{axes.x.held(std::floor(axes.x.first)), axes.y.held(std::floor(axes.y.first))},
          {axes.x.held(std::ceil(axes.x.begin(axes.x.pixels))), axes.y.held(std::ceil(axes.y.begin(axes.y.pixels)))}};
}

/// One pixel per cell.
PlacedImage square_cells(const GridGeometry& geometry, const MapFrame& frame,
                         const std::function<CellColour(CellIndex)>& colour_of_cell) {
  const CellBox box = shown_cells(pixel_axes(geometry, frame));
  if (box.empty()) return {};
  auto image =
      std::make_shared<RgbaImage>(static_cast<std::uint32_t>(box.width()), static_cast<std::uint32_t>(box.height()));
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x; ++x) {
      put(*image, static_cast<std::uint32_t>(x - box.min.x), static_cast<std::uint32_t>(box.end.y - 1 - y),
          colour_of_cell({x, y}));
    }
  }
  const MapArea area = map_area(geometry, box);
  const Point2 corner = frame.to_pixel({area.min_x_m, area.max_y_m});
  return {{corner.x(), corner.y(), area.width_m() * frame.px_per_m, area.height_m() * frame.px_per_m}, image};
}

/// Areas of free and occupied cells under the pixels of one row, in cells.
struct Areas {
  std::vector<double> free;
  std::vector<double> occupied;
};

/// Extent of a pixel on its axis, and the cells that it overlaps.
struct PixelSpan {
  double begin = 0.0;
  double end = 0.0;
  std::int32_t first = 0;
  std::int32_t last = 0;  ///< one behind
  [[nodiscard]] double covered_share(std::int32_t cell) const {
    return std::min(end, cell + 1.0) - std::max(begin, static_cast<double>(cell));
  }
};

std::vector<PixelSpan> pixel_spans(const PixelAxis& axis) {
  std::vector<PixelSpan> spans;
  spans.reserve(axis.pixels);
  for (std::uint32_t k = 0; k < axis.pixels; ++k) {
    const double begin = axis.begin(k);
    const double end = axis.begin(k + 1);
    spans.push_back({begin, end, axis.held(std::floor(begin)), axis.held(std::ceil(end))});
  }
  return spans;
}

/// Adds the row's areas under each pixel, times `weight`.
void add_row(std::span<const CellState> row, const std::vector<PixelSpan>& spans, double weight, Areas& areas) {
  for (std::size_t k = 0; k < spans.size(); ++k) {
    for (std::int32_t x = spans[k].first; x < spans[k].last; ++x) {
      const CellState state = row[static_cast<std::size_t>(x)];
      if (state == CellState::kUnknown) continue;
      (state == CellState::kFree ? areas.free : areas.occupied)[k] += weight * spans[k].covered_share(x);
    }
  }
}

/// Walls count more than their area: a wall of one cell would vanish among ten free ones.
double wall_darkness(double occupied_cells, double pixel_cells) {
  const double share = std::min(1.0, occupied_cells / pixel_cells);
  return (1.0 - kLoneCellDarkness) * std::sqrt(share) +
         kLoneCellDarkness * std::max(share, std::min(1.0, occupied_cells));
}

CellColour mean_colour(double free, double occupied, double all, const MapColours& colours) {
  const double open = std::max(1e-12, all - occupied);
  const double free_share = std::clamp(free / open, 0.0, 1.0);
  const double darkness = wall_darkness(occupied, all);
  // The wall is drawn over the free area, over a transparent background.
  const double alpha = darkness + (1.0 - darkness) * free_share;
  const double wall_share = alpha > 0.0 ? darkness / alpha : 0.0;
  return {mixed(colours.free, colours.wall, wall_share), mixed(0, 255, alpha)};
}

PlacedImage filtered_map(const OccupancyMap& map, const MapFrame& frame, const MapColours& colours) {
  const Axes axes = pixel_axes(map.geometry, frame);
  auto image = std::make_shared<RgbaImage>(axes.x.pixels, axes.y.pixels);
  const double all = axes.x.step * axes.y.step;
  const CellColour unknown = mean_colour(0.0, 0.0, all, colours);
  const auto width = static_cast<std::size_t>(map.geometry.width);
  const std::vector<PixelSpan> columns = pixel_spans(axes.x);
  const std::vector<PixelSpan> rows = pixel_spans(axes.y);
  Areas areas;
  std::vector<CellState> cells(width);
  for (std::uint32_t row = 0; row < axes.y.pixels; ++row) {
    areas.free.assign(axes.x.pixels, 0.0);
    areas.occupied.assign(axes.x.pixels, 0.0);
    for (std::int32_t y = rows[row].first; y < rows[row].last; ++y) {
      map.read_row(y, cells);
      add_row(cells, columns, rows[row].covered_share(y), areas);
    }
    for (std::uint32_t k = 0; k < axes.x.pixels; ++k) {
      const bool is_unknown = areas.free[k] == 0.0 && areas.occupied[k] == 0.0;
      put(*image, k, axes.y.pixels - 1 - row,
          is_unknown ? unknown : mean_colour(areas.free[k], areas.occupied[k], all, colours));
    }
  }
  return {frame.panel, image};
}

/// First cell whose centre lies at or beyond a border.
std::int32_t first_centre(const PixelAxis& axis, double border) { return axis.held(std::ceil(border - 0.5)); }

PlacedImage least_of_cells(const FieldPicture& field, const MapFrame& frame, const FieldColours& colours) {
  const Axes axes = pixel_axes(field.geometry, frame);
  auto image = std::make_shared<RgbaImage>(axes.x.pixels, axes.y.pixels);
  std::vector<std::uint16_t> least;
  for (std::uint32_t row = 0; row < axes.y.pixels; ++row) {
    least.assign(axes.x.pixels, field.cap);
    const std::int32_t end_y = first_centre(axes.y, axes.y.begin(row + 1));
    for (std::int32_t y = first_centre(axes.y, axes.y.begin(row)); y < end_y; ++y) {
      const std::uint16_t* const cells =
          field.cells.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(field.geometry.width);
      for (std::uint32_t k = 0; k < axes.x.pixels; ++k) {
        const std::int32_t end_x = first_centre(axes.x, axes.x.begin(k + 1));
        for (std::int32_t x = first_centre(axes.x, axes.x.begin(k)); x < end_x; ++x) {
          least[k] = std::min(least[k], cells[x]);
        }
      }
    }
    for (std::uint32_t k = 0; k < axes.x.pixels; ++k) put(*image, k, axes.y.pixels - 1 - row, colours(least[k]));
  }
  return {frame.panel, image};
}

}  // namespace

void draw(Canvas& canvas, const PlacedImage& placed) {
  if (placed.image == nullptr) return;  // no part of the grid is in the panel
  canvas.picture({placed.at.left_px, placed.at.top_px}, placed.at.width_px, placed.at.height_px, placed.image, false);
}

PlacedImage occupancy_image(const OccupancyMap& map, const MapFrame& frame, const MapColours& colours) {
  if (frame.px_per_m * map.geometry.resolution_m < kSquaresFromPx) return filtered_map(map, frame, colours);
  return square_cells(map.geometry, frame, [&](CellIndex cell) -> CellColour {
    switch (map.at(cell)) {
      case CellState::kOccupied:
        return {colours.wall, 255};
      case CellState::kFree:
        return {colours.free, 255};
      case CellState::kUnknown:
        break;
    }
    return {colours.unknown, 0};
  });
}

MapLayer wall_layer(const OccupancyMap& map, const MapColours& colours) {
  return {[&map, colours](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
            draw(canvas, occupancy_image(map, frame, colours));
          },
          [colours](const LegendLook& look, double /*px_per_m*/) {
            return LegendItems{swatch_item("wall", colours.wall, look)};
          }};
}

void check(const FieldPicture& field) {
  const GridGeometry& geometry = field.geometry;
  if (geometry.width < 1 || geometry.height < 1 || field.cells.size() != geometry.cell_count()) {
    throw InputError("the distance field has " + std::to_string(field.cells.size()) + " values for " +
                     std::to_string(geometry.width) + " x " + std::to_string(geometry.height) + " cells");
  }
  if (field.cap == 0) throw InputError("the distance field has cap 0: no cell could be known");
}

PlacedImage field_image(const FieldPicture& field, const MapFrame& frame, const FieldColours& colours) {
  if (frame.px_per_m * field.geometry.resolution_m < 1.0) return least_of_cells(field, frame, colours);
  return square_cells(field.geometry, frame, [&](CellIndex cell) {
    return colours(field.cells[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(field.geometry.width) +
                               static_cast<std::size_t>(cell.x)]);
  });
}

}  // namespace gdtslam::picture
