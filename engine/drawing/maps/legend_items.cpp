#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "gdtslam/drawing/ticks.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kGap = 0.5;           // of body_px, between a mark and its words
constexpr double kBarPx = 150.0;       // all of one unit
constexpr double kLinePiecePx = 42.0;  // of what is shown of a line
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

std::string duration_text(double seconds) {
  if (!(std::fabs(seconds) < 1e15)) return fmt::format("{:.3g} s", seconds);  // stamps of no sense
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
        // Rectangles that reach to the bar's end each, so that no seam shows between them.
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
