#include "trajectory_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/drawing/maps/map_sheet.hpp"
#include "engine/drawing/maps/path_layer.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr Colour kTruth = colour_for(0x9aa0a8);
constexpr Colour kNoError = colour_for(0xc3c7cc);  ///< of a pose that the truth does not know
constexpr double kTruthWidths = 2.6;               ///< of a path's line, of the truth under others

/// Where the poses lie, with a margin.
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
  if (area.min_x_m > area.max_x_m) area = {0.0, 0.0, 0.0, 0.0};  // no pose is a number
  const double margin_m = kMarginShare * std::max({area.width_m(), area.height_m(), kLeastSide_m});
  const double wider_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.width_m());
  const double higher_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.height_m());
  return {area.min_x_m - wider_m, area.min_y_m - higher_m, area.max_x_m + wider_m, area.max_y_m + higher_m};
}

Theme page_theme() {
  Theme theme = kLightTheme;
  theme.page = ink::kCard;
  return theme;
}

/// Lines across the whole sheet, as far apart as the scale bar is long.
void draw_grid(Canvas& canvas, const Sheet& sheet) {
  constexpr double kMostLines = 400.0;
  constexpr double kLongest_px = 190.0;  // as of the scale bar
  const MapFrame frame = whole_sheet(sheet);
  const double step_m = round_length_m(kLongest_px * sheet.sizes.unit / frame.px_per_m);
  const double width_m = frame.panel.width_px / frame.px_per_m;
  const double height_m = frame.panel.height_px / frame.px_per_m;
  if (!(step_m > 0.0) || (width_m + height_m) / step_m > kMostLines) return;
  const Pen pen{.colour = sheet.theme.grid, .width = sheet.sizes.unit};
  for (double x_m = std::ceil(frame.x_m / step_m) * step_m; x_m < frame.x_m + width_m; x_m += step_m) {
    const double x = frame.pixel_of({x_m, 0.0}).x();
    canvas.line({x, 0.0}, {x, frame.panel.height_px}, pen);
  }
  for (double y_m = std::floor(frame.y_m / step_m) * step_m; y_m > frame.y_m - height_m; y_m -= step_m) {
    const double y = frame.pixel_of({0.0, y_m}).y();
    canvas.line({0.0, y}, {frame.panel.width_px, y}, pen);
  }
}

LegendItem line_item(const std::string& words, const Pen& pen, const LegendLook& look) {
  const double piece = 42.0 * look.sizes.unit;
  const double size = look.sizes.body_px;
  const double indent = piece + 0.5 * size;
  return {indent + text_width(words, size), size, [=](Canvas& canvas, const Point2& left) {
            canvas.line(left, {left.x() + piece, left.y()}, pen);
            canvas.text({left.x() + indent, left.y() + 0.36 * size}, words, {.size = size, .colour = look.theme.text});
          }};
}

/// The page with its grid; what is drawn upon it comes before the words.
Canvas page_of(const Sheet& sheet, const MapLook& look, const char* name) {
  Canvas canvas(sheet.size.width, sheet.size.height, look.title.empty() ? name : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, sheet.size.width, sheet.size.height, Fill{sheet.theme.page});
  draw_grid(canvas, sheet);
  return canvas;
}

/// A line of one colour.
void draw_plain_path(Canvas& canvas, const MapFrame& frame, const Trajectory& path,
                     const std::vector<std::size_t>& drives, Colour colour, const ValueLine& line) {
  const std::vector<double> shares(path.size(), 0.0);
  draw_line_of_values(
      canvas, frame, {path, drives, shares}, [colour](double /*share*/) { return colour; }, line);
}

/// Least and most of what is coloured, and whether there is more.
struct ErrorScale {
  double least = 0.0;
  double most = 1.0;
  bool ends_early = false;
};

/// A few errors far out would leave one colour to all others: where the largest is far above the 99th percentile, the
/// scale ends there and says so.
ErrorScale scale_of(const PathErrors& path) {
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

PictureSize size_for_paths(const std::vector<const Trajectory*>& paths) {
  const MapArea area = area_of_paths(paths);
  return size_for_content(area.width_m(), area.height_m());
}

Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size) {
  check(path);
  const PathColours colours =
      look.colour_map.empty() ? path_colours(false) : path_colours(colour_map(look.colour_map), false);
  const LegendLook legend{page_theme(), proportions_of(size)};
  const Sheet sheet = sheet_of(area_of_paths({&path.trajectory}), look, size, legend.theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    add_path_items(items, path, look, colours, legend);
    return items;
  });
  Canvas canvas = page_of(sheet, look, "Trajectory");
  draw_path(canvas, whole_sheet(sheet), path, look, colours, sheet.sizes);
  draw_words(canvas, sheet, look);
  return canvas;
}

Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size) {
  const LegendLook legend{page_theme(), proportions_of(size)};
  std::vector<const Trajectory*> all;
  all.reserve(paths.size() + 1);
  for (const NamedPath& path : paths) all.push_back(&path.trajectory);
  if (truth != nullptr) all.push_back(truth);
  const double width = legend.sizes.line_px;
  const Sheet sheet = sheet_of(area_of_paths(all), look, size, legend.theme, [&](double px_per_m) {
    std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    if (truth != nullptr) {
      items.push_back(line_item("truth", {.colour = kTruth, .width = kTruthWidths * width}, legend));
    }
    for (std::size_t k = 0; k < paths.size(); ++k) {
      items.push_back(line_item(paths[k].name, {.colour = legend.theme.curve(k), .width = width}, legend));
    }
    return items;
  });
  Canvas canvas = page_of(sheet, look, "Trajectories");
  const MapFrame frame = whole_sheet(sheet);
  if (truth != nullptr) draw_plain_path(canvas, frame, *truth, {}, kTruth, {legend.theme.page, kTruthWidths * width});
  for (std::size_t k = 0; k < paths.size(); ++k) {
    draw_plain_path(canvas, frame, paths[k].trajectory, paths[k].drives, legend.theme.curve(k),
                    {truth != nullptr ? kTruth : legend.theme.page, width});
  }
  draw_words(canvas, sheet, look);
  return canvas;
}

Canvas path_errors_picture(const PathErrors& path, const Trajectory& truth, const MapLook& look,
                           const PictureSize& size) {
  constexpr double kWidths = 2.2;  // of a path's line: its colour is what is read
  const ErrorScale scale = scale_of(path);
  const ColourMap& map = colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map);
  const LegendLook legend{page_theme(), proportions_of(size)};
  const double width = legend.sizes.line_px;
  const Sheet sheet =
      sheet_of(area_of_paths({&path.trajectory, &truth}), look, size, legend.theme, [&](double px_per_m) {
        std::vector<LegendItem> items{scale_bar_item(px_per_m, legend), axes_item(legend)};
        items.push_back(line_item("truth", {.colour = kTruth, .width = width}, legend));
        items.push_back(colour_bar_item(
            fmt::format("{}  {:.3g}", path.quantity, scale.least),
            fmt::format("{:.3g}{}", scale.most, scale.ends_early ? " and more" : ""),
            [&map](double share) { return map.at(share); }, legend));
        return items;
      });
  std::vector<double> shares;
  shares.reserve(path.errors.size());
  for (const double error : path.errors) shares.push_back((error - scale.least) / (scale.most - scale.least));
  const auto colour_at = [&map](double share) { return std::isfinite(share) ? map.at(share) : kNoError; };
  Canvas canvas = page_of(sheet, look, "Errors along the path");
  const MapFrame frame = whole_sheet(sheet);
  draw_plain_path(canvas, frame, truth, {}, kTruth, {legend.theme.page, width});
  draw_line_of_values(canvas, frame, {path.trajectory, path.drives, shares}, colour_at,
                      {legend.theme.page, kWidths * width});
  draw_words(canvas, sheet, look);
  return canvas;
}

}  // namespace gdtslam
