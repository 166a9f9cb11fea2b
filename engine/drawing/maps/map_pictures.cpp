// Pictures of a map, of its field, of changes in it, and of paths without a map.
#include "gdtslam/drawing/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cell_image.hpp"
#include "engine/core/quantile.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "map_pictures.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr Colour kUnknownPage = colour_for(0xe4e2db);
constexpr MapColours kMapColours{ink::kText, ink::kCard, kUnknownPage};

constexpr std::uint16_t kCell = 256;  // the field's unit is 1/256 cell
constexpr Colour kPaper = colour_for(0xf0eee8);

/// Area of the obstacles and the path, and of the field around them.
MapArea shown_area(const FieldPicture& field, const Trajectory& trajectory) {
  const GridGeometry& geometry = field.geometry;
  const auto width = static_cast<std::size_t>(geometry.width);
  const auto box_below = [&](std::uint16_t limit) {
    return bounding_cells(geometry, [&](std::int32_t y, std::span<std::uint8_t> passes) {
      const auto row = field.cells.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * width);
      std::transform(row, row + static_cast<std::ptrdiff_t>(width), passes.begin(),
                     [&](std::uint16_t value) { return static_cast<std::uint8_t>(value < limit); });
    });
  };
  CellBox box = box_below(std::min(kCell, field.cap));
  if (box.empty()) box = box_below(field.cap);
  if (box.empty()) box = {{0, 0}, {geometry.width, geometry.height}};
  const double reach_m = geometry.resolution_m * field.cap / kCell;
  return with_path(map_area(geometry, box), geometry, trajectory, std::max(reach_m, 2.0 * geometry.resolution_m));
}

/// Colours of the field's values.
struct FieldLook {
  const ColourMap& map;
  bool is_intensity = true;
  double least_share = 0.0;  ///< start in the colour map; the darker colours are left to unknown cells
  Colour unknown;
  /// 0 at an obstacle, 1 at the cap.
  [[nodiscard]] Colour at(double distance_share) const {
    const double share = is_intensity ? 1.0 - distance_share : distance_share;
    return map.at(least_share + (1.0 - least_share) * share);
  }
};

FieldLook field_look(const MapLook& look) {
  constexpr double kDarkestShare = 0.22;
  if (look.is_intensity) {
    return {colour_map(look.colour_map.empty() ? "glow" : look.colour_map), true, kDarkestShare, ink::kNight};
  }
  return {colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map), false, 0.0, kPaper};
}

/// Table with the colour of each value, because a field has millions of cells.
FieldColours colour_table(const FieldLook& look, std::uint16_t cap, bool is_transparent) {
  std::vector<CellColour> table;
  for (std::uint32_t value = 0; value < cap; ++value) table.push_back({look.at(static_cast<double>(value) / cap), 255});
  const CellColour unknown{look.unknown, static_cast<std::uint8_t>(is_transparent ? 0 : 255)};
  return [table = std::move(table), unknown](std::uint16_t value) {
    return value < table.size() ? table[value] : unknown;
  };
}

MapLayer field_layer(const FieldPicture& field, const FieldLook& colours, bool is_transparent) {
  return {[&field, &colours, is_transparent](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
            draw(canvas, field_image(field, frame, colour_table(colours, field.cap, is_transparent)));
          },
          [&field, &colours](const LegendLook& look, double /*px_per_m*/) {
            const std::string reach = length_text(field.geometry.resolution_m * field.cap / kCell);
            const bool is_bright = colours.is_intensity;
            const auto colour_at = [&colours, is_bright](double share) {
              return colours.at(is_bright ? 1.0 - share : share);
            };
            return LegendItems{colour_bar_item(is_bright ? "intensity 0 at " + reach : "nearest obstacle at 0 m",
                                               is_bright ? "1 at obstacles" : reach, colour_at, look),
                               swatch_item("farther or unknown", colours.unknown, look)};
          }};
}

/// Pale colours, so that changes stand out.
constexpr MapColours kChangesMap{colour_for(0x8f959d), ink::kCard, colour_for(0xebe9e3)};
constexpr Colour kAppeared = ink::kCoupler;
constexpr Colour kGone = ink::kCrank;
constexpr Colour kDrive = colour_for(0x9db7a8);

// Draws runs of cells as one rectangle, and no rectangle too small to see.
void draw_cells(Canvas& canvas, const MapFrame& frame, const GridGeometry& grid, const ChangesLayer& layer,
                Colour colour, const Proportions& sizes) {
  const double grown = std::max(0.0, 0.5 * (1.6 * sizes.line_px - grid.resolution_m * frame.px_per_m));
  for (std::size_t k = 0; k < layer.cells.size();) {
    const CellIndex first = layer.cells[k].cell;
    std::int32_t length = 0;
    while (k < layer.cells.size() && layer.cells[k].cell == first + CellOffset{length, 0}) ++k, ++length;
    const MapArea area = map_area(grid, {first, first + CellOffset{length, 1}});
    const Point2 corner = frame.to_pixel({area.min_x_m, area.max_y_m}) - Point2(grown, grown);
    canvas.rectangle(corner, area.width_m() * frame.px_per_m + 2.0 * grown,
                     area.height_m() * frame.px_per_m + 2.0 * grown, Fill{colour});
  }
}

std::vector<CellBox> patch_boxes(const ChangesLayer& layer) {
  std::vector<CellBox> boxes(layer.patches);
  for (const auto& [cell, patch] : layer.cells) {
    CellBox& box = boxes.at(patch);
    if (box.empty()) box = {cell, cell + CellOffset{1, 1}};
    box.min = {std::min(box.min.x, cell.x), std::min(box.min.y, cell.y)};
    box.end = {std::max(box.end.x, cell.x + 1), std::max(box.end.y, cell.y + 1)};
  }
  return boxes;
}

void draw_frames(Canvas& canvas, const MapFrame& frame, const GridGeometry& grid, const ChangesLayer& layer,
                 Colour colour, const Proportions& sizes) {
  const double pad = 4.0 * sizes.line_px;
  for (const CellBox& box : patch_boxes(layer)) {
    const MapArea area = map_area(grid, box);
    const Point2 corner = frame.to_pixel({area.min_x_m, area.max_y_m}) - Point2(pad, pad);
    canvas.rectangle(corner, area.width_m() * frame.px_per_m + 2.0 * pad, area.height_m() * frame.px_per_m + 2.0 * pad,
                     Fill{colour, 0.1}, Pen{.colour = colour, .width = 0.6 * sizes.line_px, .opacity = 0.55}, pad);
  }
}

std::string places_text(const char* what, std::uint32_t places) {
  if (places == 0) return std::string("nothing ") + what;
  return std::string(what) + ": " + std::to_string(places) + (places == 1 ? " place" : " places");
}

MapLayer changes_layer(const GridGeometry& grid, const ChangesLayer& layer, const char* what, Colour colour) {
  return {[&grid, &layer, colour](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
            draw_frames(canvas, frame, grid, layer, colour, sizes);
            draw_cells(canvas, frame, grid, layer, colour, sizes);
          },
          [&layer, what, colour](const LegendLook& look, double /*px_per_m*/) {
            return LegendItems{swatch_item(places_text(what, layer.patches), colour, look)};
          }};
}

constexpr Colour kTruth = colour_for(0x9aa0a8);
constexpr Colour kNoError = colour_for(0xc3c7cc);  ///< a pose without a true pose
constexpr double kTruthWidths = 2.6;               ///< width of the truth below other paths, in widths of a path's line
constexpr double kErrorWidths = 2.2;               ///< width of a path with meaningful colours, in the same unit

/// The area of the poses, with a margin.
MapArea area_of_paths(const std::vector<const Trajectory*>& paths) {
  constexpr double kLeastSide_m = 1.0;
  constexpr double kMarginShare = 0.04;
  MapArea area{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
               std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  for (const Trajectory* const path : paths) {
    for (const StampedPose& pose : *path) {
      if (!pose.T_map_base.is_finite()) continue;
      area.min_x_m = std::min(area.min_x_m, pose.T_map_base.x_m);
      area.max_x_m = std::max(area.max_x_m, pose.T_map_base.x_m);
      area.min_y_m = std::min(area.min_y_m, pose.T_map_base.y_m);
      area.max_y_m = std::max(area.max_y_m, pose.T_map_base.y_m);
    }
  }
  if (area.min_x_m > area.max_x_m) area = {0.0, 0.0, 0.0, 0.0};  // no pose is finite
  const double margin_m = kMarginShare * std::max({area.width_m(), area.height_m(), kLeastSide_m});
  const double wider_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.width_m());
  const double higher_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.height_m());
  return {area.min_x_m - wider_m, area.min_y_m - higher_m, area.max_x_m + wider_m, area.max_y_m + higher_m};
}

MapSheet page_of_paths(const char* name, const std::vector<const Trajectory*>& paths) {
  return {name, area_of_paths(paths), light_theme(ink::kCard), {grid_layer(kLightTheme.grid)}};
}

/// Range of the coloured errors, and whether larger ones exist.
struct ErrorScale {
  double least = 0.0;
  double most = 1.0;
  bool ends_early = false;
};

/// A few very large errors would leave one colour for all the others. If the largest is far above the 99th percentile,
/// the scale ends at that percentile, and the picture says so.
ErrorScale error_scale(const PathErrors& path) {
  constexpr double kShare = 0.99;
  constexpr double kFar = 1.5;
  std::vector<double> known;
  for (const double error : path.errors) {
    if (std::isfinite(error)) known.push_back(error);
  }
  if (known.empty()) throw InputError("none of the poses has an error to colour it by");
  std::sort(known.begin(), known.end());
  const double usual = quantile_of_sorted(known, kShare);
  const double shown = known.back() > kFar * usual ? usual : known.back();
  ErrorScale scale{path.least.value_or(0.0), path.most.value_or(shown)};
  if (!(scale.least < scale.most)) scale.most = scale.least + 1.0;
  scale.ends_early = known.back() > scale.most;
  return scale;
}

}  // namespace

PictureSize size_for_content(double width, double height) {
  constexpr std::uint32_t kWidth_px = 1600;
  constexpr double kCaption_px = 240.0;  // title above, bars below
  constexpr double kLowest_px = 500.0;
  constexpr double kHighest_px = 1600.0;
  const double rows = height / std::max(width, 1e-3) * 0.92 * kWidth_px + kCaption_px;
  return {kWidth_px, static_cast<std::uint32_t>(std::clamp(rows, kLowest_px, kHighest_px))};
}

Canvas map_picture(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look, const PictureSize& size) {
  check(overlay);
  const PathColours colours = path_colours(false, look.colour_map);
  MapSheet sheet{"Map", shown_area(map, overlay.trajectory), light_theme(kUnknownPage), {}};
  sheet.layers = {wall_layer(map, kMapColours), swatch_layer("free", kMapColours.free)};
  if (!look.is_transparent) sheet.layers.push_back(swatch_layer("unknown", kUnknownPage));
  sheet.layers.push_back(path_layer(overlay, look, colours));
  return drawn(sheet, look, size);
}

Canvas field_picture(const FieldPicture& field, const PathOverlay& overlay, const MapLook& look,
                     const PictureSize& size) {
  check(field);
  check(overlay);
  const FieldLook colours = field_look(look);
  const PathColours path = path_colours(look.is_intensity);
  // A transparent picture is usually shown on a light page.
  Theme theme = look.is_intensity && !look.is_transparent ? kDarkTheme : kLightTheme;
  theme.page = colours.unknown;
  return drawn({"Distance field",
                shown_area(field, overlay.trajectory),
                theme,
                {field_layer(field, colours, look.is_transparent), path_layer(overlay, look, path)}},
               look, size);
}

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const double width = 0.6 * picture_proportions(size).line_px;
  Trajectory extent;
  for (const Trajectory& drive : overlay.drives) extent.insert(extent.end(), drive.begin(), drive.end());
  MapSheet sheet{"Changes", shown_area(map, extent), light_theme(kChangesMap.unknown), {wall_layer(map, kChangesMap)}};
  for (const Trajectory& drive : overlay.drives) {
    sheet.layers.push_back(line_layer(drive, one_drive, "seen from here", kDrive, {std::nullopt, width}));
    if (sheet.layers.size() > 2) sheet.layers.back().explain = {};
  }
  sheet.layers.push_back(changes_layer(map.geometry, overlay.gone, "gone", kGone));
  sheet.layers.push_back(changes_layer(map.geometry, overlay.appeared, "new", kAppeared));
  return drawn(sheet, look, size);
}

PictureSize size_for_paths(const std::vector<const Trajectory*>& paths) {
  const MapArea area = area_of_paths(paths);
  return size_for_content(area.width_m(), area.height_m());
}

Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size) {
  check(path);
  const PathColours colours = path_colours(false, look.colour_map);
  MapSheet sheet = page_of_paths("Trajectory", {&path.trajectory});
  sheet.layers.push_back(path_layer(path, look, colours));
  return drawn(sheet, look, size);
}

Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const double width = picture_proportions(size).line_px;
  std::vector<const Trajectory*> all;
  all.reserve(paths.size() + 1);
  for (const NamedPath& path : paths) all.push_back(&path.trajectory);
  if (truth != nullptr) all.push_back(truth);
  MapSheet sheet = page_of_paths("Trajectories", all);
  const Colour halo = truth != nullptr ? kTruth : sheet.theme.page;
  if (truth != nullptr) {
    sheet.layers.push_back(line_layer(*truth, one_drive, "truth", kTruth, {sheet.theme.page, kTruthWidths * width}));
  }
  for (std::size_t k = 0; k < paths.size(); ++k) {
    sheet.layers.push_back(
        line_layer(paths[k].trajectory, paths[k].drives, paths[k].name, sheet.theme.curve(k), {halo, width}));
  }
  return drawn(sheet, look, size);
}

Canvas path_errors_picture(const PathErrors& path, const Trajectory& truth, const MapLook& look,
                           const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const ErrorScale scale = error_scale(path);
  const ColourMap& map = colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map);
  const double width = picture_proportions(size).line_px;
  std::vector<double> shares;
  for (const double error : path.errors) shares.push_back((error - scale.least) / (scale.most - scale.least));
  MapSheet sheet = page_of_paths("Errors along the path", {&path.trajectory, &truth});
  const Colour page = sheet.theme.page;
  sheet.layers.push_back(line_layer(truth, one_drive, "truth", kTruth, {page, width}));
  sheet.layers.push_back({[&](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
                            const auto colour_at = [&map](double share) {
                              return std::isfinite(share) ? map.at(share) : kNoError;
                            };
                            draw_line_of_values(canvas, frame, {path.trajectory, path.drives, shares}, colour_at,
                                                {page, kErrorWidths * width});
                          },
                          [&](const LegendLook& legend, double /*px_per_m*/) {
                            return LegendItems{colour_bar_item(
                                fmt::format("{}  {:.3g}", path.quantity, scale.least),
                                fmt::format("{:.3g}{}", scale.most, scale.ends_early ? " and more" : ""),
                                [&map](double share) { return map.at(share); }, legend)};
                          }});
  return drawn(sheet, look, size);
}

}  // namespace gdtslam
