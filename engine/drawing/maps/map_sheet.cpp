#include "map_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/drawing/letters.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kTitleLine = 1.35;  // in letter sizes
constexpr double kSubtitleLine = 1.5;
constexpr double kRowGap = 0.75;           // in body_px, between rows of the legend
constexpr double kLongestScalePx = 190.0;  // the same as for the scale bar
constexpr int kRounds = 3;  // rounds after which the scale bar, which depends on the map's size, is stable

double title_height(const MapLook& look, const Proportions& sizes) {
  double height = 0.0;
  if (!look.title.empty()) height += kTitleLine * sizes.title_px;
  if (!look.subtitle.empty()) height += kSubtitleLine * sizes.body_px;
  return height > 0.0 ? height + 0.4 * sizes.body_px : 0.0;
}

/// Positions of the items relative to the legend's upper left corner, and their total size.
struct Arrangement {
  std::vector<Point2> places;
  double width_px = 0.0;
  double height_px = 0.0;
};

/// Fills row after row, like words on a page.
Arrangement arrange_rows(const LegendItems& items, double room_px, double gap_px, const Proportions& sizes,
                         bool keeps_groups = false) {
  Arrangement all;
  double top = 0.0;
  for (std::size_t begin = 0; begin < items.size();) {
    double x = 0.0;
    double height = 0.0;
    std::size_t end = begin;
    while (end < items.size() && (end == begin || x + items[end].width_px <= room_px)) {
      if (keeps_groups && end > begin && items[end].begins_row) break;
      x += items[end].width_px + gap_px;
      height = std::max(height, items[end++].height_px);
    }
    x = 0.0;
    for (; begin < end; ++begin) {
      all.places.emplace_back(x, top + 0.5 * height);
      x += items[begin].width_px + gap_px;
    }
    all.width_px = std::max(all.width_px, x - gap_px);
    all.height_px = top + height;
    top += height + kRowGap * sizes.body_px;
  }
  return all;
}

/// Uses as few rows as possible with smaller gaps.
Arrangement fewest_rows(const LegendItems& items, double room_px, const Proportions& sizes) {
  Arrangement best = arrange_rows(items, room_px, sizes.gap_px, sizes);
  for (const double share : {0.8, 0.6}) {
    Arrangement closer = arrange_rows(items, room_px, share * sizes.gap_px, sizes);
    if (closer.height_px < best.height_px) best = std::move(closer);
  }
  Arrangement grouped = arrange_rows(items, room_px, sizes.gap_px, sizes, true);
  const bool is_one_row = best.height_px <= 2.0 * sizes.body_px;
  if (!is_one_row && grouped.height_px <= best.height_px + 1e-9) best = std::move(grouped);
  return best;
}

Arrangement one_column(const LegendItems& items, const Proportions& sizes) {
  return arrange_rows(items, 0.0, sizes.gap_px, sizes);
}

struct Layout {
  MapFrame frame;
  Arrangement legend;
  Point2 corner;
};

Panel panel_between(double left, double top, double right, double bottom) {
  const double x = std::floor(left);
  const double y = std::floor(top);
  return {x, y, std::max(1.0, std::floor(right) - x), std::max(1.0, std::floor(bottom) - y)};
}

Layout with_legend_below(const MapArea& area, const PictureSize& size, const Proportions& sizes, double top,
                         const LegendItems& items) {
  const double margin = sizes.margin_px;
  Layout layout;
  layout.legend = fewest_rows(items, size.width - 2.0 * margin, sizes);
  const double bottom = size.height - 0.7 * margin - layout.legend.height_px;
  layout.corner = {margin, bottom};
  layout.frame = fitted(area, panel_between(margin, top, size.width - margin, bottom - 0.5 * margin));
  return layout;
}

Layout with_legend_beside(const MapArea& area, const PictureSize& size, const Proportions& sizes, double top,
                          const LegendItems& items) {
  const double margin = sizes.margin_px;
  Layout layout;
  layout.legend = one_column(items, sizes);
  const double right = size.width - margin - layout.legend.width_px;
  layout.corner = {right, size.height - margin - layout.legend.height_px};
  layout.frame = fitted(area, panel_between(margin, top, right - margin, size.height - margin));
  return layout;
}

/// Changes the scale and keeps the centre.
MapFrame scaled(MapFrame frame, double px_per_m) {
  const double more = 0.5 / px_per_m - 0.5 / frame.px_per_m;
  frame.x_m -= more * frame.panel.width_px;
  frame.y_m += more * frame.panel.height_px;
  frame.px_per_m = px_per_m;
  return frame;
}

/// Covers an area behind words with the page's colour, which hides rays and walls.
void dim(Canvas& canvas, const Sheet& sheet, const Point2& corner, double width, double height) {
  const double pad = 0.35 * sheet.sizes.body_px;
  canvas.rectangle({corner.x() - pad, corner.y() - pad}, width + 2.0 * pad, height + 2.0 * pad,
                   Fill{sheet.theme.page, 0.75}, std::nullopt, pad);
}

void draw_line(Canvas& canvas, const Sheet& sheet, const FittedWords& words, double y, const Lettering& lettering,
               bool is_dimmed) {
  const double left = sheet.sizes.margin_px;
  const double width = text_width(words.text, words.size_px, lettering.is_bold);
  if (is_dimmed) dim(canvas, sheet, {left, y}, width, words.size_px);
  Lettering fitted = lettering;
  fitted.size = words.size_px;
  canvas.text({left, y + 0.8 * words.size_px}, words.text, fitted);
}

/// Shrinks or shortens the title to its room, and dims the map below it.
void draw_title(Canvas& canvas, const Sheet& sheet, const MapLook& look) {
  const Proportions& sizes = sheet.sizes;
  const double room = sheet.size.width - 2.0 * sizes.margin_px;
  const bool is_dimmed = !look.is_transparent;
  double y = 0.7 * sizes.margin_px;
  if (!look.title.empty()) {
    draw_line(canvas, sheet, fitted_words(look.title, sizes.title_px, sizes.body_px, room, true), y,
              {.colour = sheet.theme.text, .is_bold = true}, is_dimmed);
    y += kTitleLine * sizes.title_px;
  }
  if (!look.subtitle.empty()) {
    draw_line(canvas, sheet, fitted_words(look.subtitle, sizes.body_px, 0.8 * sizes.body_px, room, false), y,
              {.colour = sheet.theme.quiet}, is_dimmed);
  }
}

void draw_legend(Canvas& canvas, const Sheet& sheet, bool is_dimmed) {
  for (std::size_t i = 0; i < sheet.places.size(); ++i) {
    const LegendItem& item = sheet.items[i];
    const Point2& place = sheet.places[i];
    if (is_dimmed) {
      dim(canvas, sheet, {place.x(), place.y() - 0.5 * item.height_px}, item.width_px, item.height_px);
    }
    item.draw(canvas, place);
  }
}

/// Extends the map to the whole sheet: observed cells beyond the walls are not cut at the border of the panel.
MapFrame whole_sheet(const Sheet& sheet) {
  MapFrame whole = sheet.frame;
  whole.panel = {0.0, 0.0, static_cast<double>(sheet.size.width), static_cast<double>(sheet.size.height)};
  whole.x_m -= sheet.frame.panel.left_px / whole.px_per_m;
  whole.y_m += sheet.frame.panel.top_px / whole.px_per_m;
  return whole;
}

constexpr double kGap = 0.5;           // in body_px, between a mark and its words
constexpr double kBarPx = 150.0;       // all of one unit
constexpr double kLinePiecePx = 42.0;  // length of a line in the legend
constexpr double kLongestScaleItemPx = 190.0;
constexpr int kBarSteps = 64;

void draw_axes(Canvas& canvas, const Point2& origin, double arm, const LegendLook& look) {
  const Colour colour = look.theme.text;
  const double head = 0.28 * look.sizes.body_px;
  const Point2 x_end = origin + Point2(arm, 0.0);
  const Point2 y_end = origin + Point2(0.0, -arm);
  canvas.polyline({y_end, origin, x_end}, {.colour = colour, .width = 1.6 * look.sizes.unit});
  canvas.polygon(
      {x_end + Point2(head, 0.0), x_end + Point2(-0.4 * head, -0.6 * head), x_end + Point2(-0.4 * head, 0.6 * head)},
      Fill{colour});
  canvas.polygon(
      {y_end + Point2(0.0, -head), y_end + Point2(-0.6 * head, 0.4 * head), y_end + Point2(0.6 * head, 0.4 * head)},
      Fill{colour});
  const double size = look.sizes.small_px;
  const Lettering letters{.size = size, .colour = look.theme.quiet};
  canvas.text(x_end + Point2(2.0 * head, 0.3 * size), "x", letters);
  canvas.text(y_end + Point2(1.8 * head, 0.5 * size), "y", letters);
}

}  // namespace

Sheet lay_out_sheet(const MapArea& area, const MapLook& look, const PictureSize& size, const Theme& theme,
                    const LegendOf& legend) {
  Sheet sheet{.size = size, .sizes = picture_proportions(size), .theme = theme, .frame = {}, .items = {}, .places = {}};
  const double width = static_cast<double>(size.width);
  const double height = static_cast<double>(size.height);
  sheet.frame = fitted(area, {0.0, 0.0, width, height});
  if (std::min(size.width, size.height) < kLeastSideWithWords) return sheet;
  const double top = 0.7 * sheet.sizes.margin_px + title_height(look, sheet.sizes);
  for (int round = 1;; ++round) {
    const double px_per_m = sheet.frame.px_per_m;
    sheet.items = legend(px_per_m);
    Layout layout = with_legend_below(area, size, sheet.sizes, top, sheet.items);
    Layout beside = with_legend_beside(area, size, sheet.sizes, top, sheet.items);
    const bool fits_beside = beside.legend.height_px + top + sheet.sizes.margin_px <= height;
    if (fits_beside && beside.frame.px_per_m > layout.frame.px_per_m) layout = std::move(beside);
    sheet.frame = layout.frame;
    sheet.places = std::move(layout.legend.places);
    for (Point2& place : sheet.places) place += layout.corner;
    if (sheet.frame.px_per_m == px_per_m) return sheet;
    // Legend and map may alternate between two sizes: then the map keeps the smaller one.
    if (round < kRounds || sheet.frame.px_per_m < px_per_m) continue;
    sheet.frame = scaled(sheet.frame, px_per_m);
    return sheet;
  }
}

FittedWords fitted_words(const std::string& words, double size_px, double least_px, double room_px, bool is_bold) {
  const double width = text_width(words, size_px, is_bold);
  if (width <= room_px) return {words, size_px};
  const double smaller_px = std::max(std::min(size_px, least_px), size_px * room_px / width);
  return {shortened(words, smaller_px, room_px, is_bold), smaller_px};
}

Theme light_theme(Colour page) {
  Theme theme = kLightTheme;
  theme.page = page;
  return theme;
}

Canvas drawn(const MapSheet& content, const MapLook& look, const PictureSize& size) {
  const LegendLook legend{content.theme, picture_proportions(size)};
  const Sheet sheet = lay_out_sheet(content.area, look, size, content.theme, [&](double px_per_m) {
    LegendItems items{scale_bar_item(px_per_m, legend), axes_item(legend)};
    for (const MapLayer& layer : content.layers) {
      if (!layer.explain) continue;
      for (LegendItem& item : layer.explain(legend, px_per_m)) items.push_back(std::move(item));
    }
    return items;
  });
  Canvas canvas(size.width, size.height, look.title.empty() ? content.name : look.title);
  if (!look.is_transparent) canvas.rectangle({0.0, 0.0}, size.width, size.height, Fill{content.theme.page});
  const MapFrame frame = whole_sheet(sheet);
  canvas.begin_clip({0.0, 0.0}, size.width, size.height);
  for (const MapLayer& layer : content.layers) {
    if (layer.draw) layer.draw(canvas, frame, sheet.sizes);
  }
  canvas.end_clip();
  if (sheet.places.empty()) return canvas;
  draw_title(canvas, sheet, look);
  draw_legend(canvas, sheet, !look.is_transparent);
  return canvas;
}

MapLayer grid_layer(Colour colour) {
  return {[colour](Canvas& canvas, const MapFrame& frame, const Proportions& sizes) {
            constexpr double kMostLines = 400.0;
            const double step_m = round_length_m(kLongestScalePx * sizes.unit / frame.px_per_m);
            const double width_m = frame.panel.width_px / frame.px_per_m;
            const double height_m = frame.panel.height_px / frame.px_per_m;
            if (!(step_m > 0.0) || (width_m + height_m) / step_m > kMostLines) return;
            const Pen pen{.colour = colour, .width = sizes.unit};
            const double step_px = step_m * frame.px_per_m;
            const Point2 first =
                frame.to_pixel({std::ceil(frame.x_m / step_m) * step_m, std::floor(frame.y_m / step_m) * step_m});
            for (double x = first.x(); x < frame.panel.width_px; x += step_px) {
              canvas.line({x, 0.0}, {x, frame.panel.height_px}, pen);
            }
            for (double y = first.y(); y < frame.panel.height_px; y += step_px) {
              canvas.line({0.0, y}, {frame.panel.width_px, y}, pen);
            }
          },
          {}};
}

std::string duration_text(double seconds) {
  if (!(std::fabs(seconds) < 1e15)) return fmt::format("{:.3g} s", seconds);  // implausible stamps
  const auto whole = static_cast<long long>(std::floor(seconds + 0.5));
  if (whole < 120) return fmt::format("{} s", whole);
  const bool is_long = whole >= 7200;
  const long long large = whole / (is_long ? 3600 : 60);
  const long long small = is_long ? whole % 3600 / 60 : whole % 60;
  const std::string text = fmt::format("{} {}", large, is_long ? "h" : "min");
  return small == 0 ? text : fmt::format("{} {} {}", text, small, is_long ? "min" : "s");
}

LegendItem legend_item(const std::string& before, double mark_px, std::function<void(Canvas&, const Point2&)> draw_mark,
                       const std::string& after, const LegendLook& look) {
  const double size = look.sizes.body_px;
  const double mark = before.empty() ? 0.0 : text_width(before, size) + kGap * size;
  const double words = mark + mark_px + kGap * size;
  return {words + text_width(after, size), size,
          [=, draw_mark = std::move(draw_mark)](Canvas& canvas, const Point2& left) {
            const Point2 base = left + Point2(0.0, 0.36 * size);
            const Lettering letters{.size = size, .colour = look.theme.text};
            if (!before.empty()) canvas.text(base, before, letters);
            draw_mark(canvas, left + Point2(mark, 0.0));
            if (!after.empty()) canvas.text(base + Point2(words, 0.0), after, letters);
          }};
}

LegendItem scale_bar_item(double px_per_m, const LegendLook& look) {
  const double length_m = round_length_m(kLongestScaleItemPx * look.sizes.unit / px_per_m);
  const double length = length_m * px_per_m;
  const Pen pen{.colour = look.theme.text, .width = 2.0 * look.sizes.unit};
  const Point2 tall(0.0, 0.35 * look.sizes.body_px);
  return legend_item(
      "", length,
      [=](Canvas& canvas, const Point2& left) {
        const Point2 right = left + Point2(length, 0.0);
        canvas.polyline({left - tall, left + tall, right + tall, right - tall}, pen);
      },
      length_text(length_m), look);
}

LegendItem axes_item(const LegendLook& look) {
  const double arm = 1.5 * look.sizes.body_px;
  return {arm + 1.6 * look.sizes.small_px, 1.9 * look.sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            draw_axes(canvas, {left.x() + 0.2 * look.sizes.small_px, left.y() + 0.5 * arm}, arm, look);
          }};
}

LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look) {
  const double side = 0.95 * look.sizes.body_px;
  const Pen edge{.colour = look.theme.quiet, .width = look.sizes.unit};
  return legend_item(
      "", side,
      [=](Canvas& canvas, const Point2& left) {
        canvas.rectangle(left - Point2(0.0, 0.5 * side), side, side, Fill{colour}, edge);
      },
      words, look);
}

LegendItem line_item(const std::string& words, const Pen& pen, const LegendLook& look) {
  const double piece = kLinePiecePx * look.sizes.unit;
  return legend_item(
      "", piece, [=](Canvas& canvas, const Point2& left) { canvas.line(left, left + Point2(piece, 0.0), pen); }, words,
      look);
}

LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look) {
  const double bar = kBarPx * look.sizes.unit;
  const double height = 0.8 * look.sizes.body_px;
  return legend_item(
      before, bar,
      [=, colour_at = std::move(colour_at)](Canvas& canvas, const Point2& left) {
        // Rectangles that all reach to the bar's end leave no visible seams.
        for (int i = 0; i < kBarSteps; ++i) {
          const double from = bar * i / kBarSteps;
          canvas.rectangle(left + Point2(from, -0.5 * height), bar - from, height,
                           Fill{colour_at((i + 0.5) / kBarSteps)});
        }
      },
      after, look);
}

MapLayer swatch_layer(const std::string& words, Colour colour) {
  return {{}, [=](const LegendLook& look, double) { return LegendItems{swatch_item(words, colour, look)}; }};
}

}  // namespace gdtslam::picture
