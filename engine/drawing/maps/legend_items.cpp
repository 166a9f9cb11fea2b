#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "gdtslam/drawing/ticks.hpp"
#include "map_sheet.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kWordsAfter = 0.5;  // of body_px, from a mark to its words
constexpr double kBarPx = 150.0;     // all of one unit
constexpr double kLongestScalePx = 190.0;
constexpr int kBarSteps = 64;

void write(Canvas& canvas, const Point2& left_middle, const std::string& words, const LegendLook& look) {
  const double size = look.sizes.body_px;
  canvas.text({left_middle.x(), left_middle.y() + 0.36 * size}, words, {.size = size, .colour = look.theme.text});
}

double width_of(const std::string& words, const LegendLook& look) { return text_width(words, look.sizes.body_px); }

using DrawMark = void (*)(Canvas&, const Point2&, const PathColours&, const Proportions&);
LegendItem mark_item(const std::string& words, double mark_px, const PathColours& colours, const LegendLook& look,
                     DrawMark draw_mark) {
  const double indent = mark_px + kWordsAfter * look.sizes.body_px;
  return {indent + width_of(words, look), look.sizes.body_px,
          [words, mark_px, indent, &colours, look, draw_mark](Canvas& canvas, const Point2& left) {
            draw_mark(canvas, {left.x() + 0.5 * mark_px, left.y()}, colours, look.sizes);
            write(canvas, {left.x() + indent, left.y()}, words, look);
          }};
}

/// Rectangles that reach to the bar's end each, so that no seam shows between them.
void draw_bar(Canvas& canvas, const Point2& left, double width, double height,
              const std::function<Colour(double)>& colour_at) {
  for (int i = 0; i < kBarSteps; ++i) {
    const double from = width * i / kBarSteps;
    canvas.rectangle({left.x() + from, left.y() - 0.5 * height}, width - from, height,
                     Fill{colour_at((i + 0.5) / kBarSteps)});
  }
}

LegendItem time_item(double seconds, const PathColours& colours, const LegendLook& look) {
  const std::string start = "start";
  const std::string end = seconds > 0.0 ? "end, after " + duration_text(seconds) : "end";
  const double gap = 18.0 * look.sizes.unit;
  const double bar = kBarPx * look.sizes.unit;
  const double before = width_of(start, look);
  return {before + bar + 2.0 * gap + width_of(end, look), look.sizes.body_px,
          [=, &colours](Canvas& canvas, const Point2& left) {
            write(canvas, left, start, look);
            const Point2 from{left.x() + before + gap, left.y()};
            const Point2 to{from.x() + bar, left.y()};
            draw_bar(canvas, from, bar, 2.0 * look.sizes.line_px,
                     [&](double share) { return time_colour(colours, share); });
            draw_start(canvas, from, colours, look.sizes);
            draw_end(canvas, to, colours, look.sizes);
            write(canvas, {to.x() + gap, to.y()}, end, look);
          }};
}

/// A piece of the path with keyframes on it: dots alone would be too small to be known again.
LegendItem keyframe_item(const std::string& words, const PathColours& colours, const LegendLook& look) {
  const double piece = 42.0 * look.sizes.unit;
  const double indent = piece + kWordsAfter * look.sizes.body_px;
  return {indent + width_of(words, look), look.sizes.body_px, [=, &colours](Canvas& canvas, const Point2& left) {
            constexpr double kShare = 0.5;
            canvas.line(left, {left.x() + piece, left.y()},
                        {.colour = time_colour(colours, kShare), .width = look.sizes.line_px});
            for (const double at : {0.2, 0.5, 0.8}) {
              draw_keyframe(canvas, {left.x() + at * piece, left.y()}, keyframe_colour(colours, kShare), look.sizes);
            }
            write(canvas, {left.x() + indent, left.y()}, words, look);
          }};
}

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

LegendItem scale_bar_item(double px_per_m, const LegendLook& look) {
  const double length_m = round_length_m(kLongestScalePx * look.sizes.unit / px_per_m);
  const double length = length_m * px_per_m;
  const std::string words = length_text(length_m);
  const double indent = length + kWordsAfter * look.sizes.body_px;
  return {indent + width_of(words, look), look.sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            const double tall = 0.35 * look.sizes.body_px;
            canvas.polyline({{left.x(), left.y() - tall},
                             {left.x(), left.y() + tall},
                             {left.x() + length, left.y() + tall},
                             {left.x() + length, left.y() - tall}},
                            {.colour = look.theme.text, .width = 2.0 * look.sizes.unit});
            write(canvas, {left.x() + indent, left.y()}, words, look);
          }};
}

LegendItem axes_item(const LegendLook& look) {
  const double arm = 1.5 * look.sizes.body_px;
  return {arm + 1.6 * look.sizes.small_px, 1.9 * look.sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            draw_axes(canvas, {left.x() + 0.2 * look.sizes.small_px, left.y() + 0.5 * arm}, arm, look);
          }};
}

LegendItem swatch_item(const std::string& words, Colour colour, const LegendLook& look) {
  const double side = 0.95 * look.sizes.body_px;
  const double indent = side + kWordsAfter * look.sizes.body_px;
  return {indent + width_of(words, look), look.sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            canvas.rectangle({left.x(), left.y() - 0.5 * side}, side, side, Fill{colour},
                             Pen{.colour = look.theme.quiet, .width = look.sizes.unit});
            write(canvas, {left.x() + indent, left.y()}, words, look);
          }};
}

LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const LegendLook& look) {
  const double gap = kWordsAfter * look.sizes.body_px;
  const double bar = kBarPx * look.sizes.unit;
  const double indent = width_of(before, look) + gap;
  return {indent + bar + gap + width_of(after, look), look.sizes.body_px,
          [=, colour_at = std::move(colour_at)](Canvas& canvas, const Point2& left) {
            write(canvas, left, before, look);
            draw_bar(canvas, {left.x() + indent, left.y()}, bar, 0.8 * look.sizes.body_px, colour_at);
            write(canvas, {left.x() + indent + bar + gap, left.y()}, after, look);
          }};
}

void add_path_items(std::vector<LegendItem>& items, const PathOverlay& overlay, const MapLook& look,
                    const PathColours& colours, const LegendLook& legend) {
  const std::size_t first = items.size();
  if (look.with_path && !overlay.trajectory.empty()) {
    items.push_back(time_item(duration_s(overlay.trajectory), colours, legend));
  }
  if (look.with_keyframes && !overlay.keyframes.empty()) {
    items.push_back(keyframe_item(counted(overlay.keyframes.size(), "keyframe"), colours, legend));
  }
  if (!overlay.doubtful.empty()) {
    items.push_back(mark_item(counted(overlay.doubtful.size(), "doubtful scan"), 1.1 * legend.sizes.body_px, colours,
                              legend, draw_doubtful));
  }
  if (first < items.size()) items[first].begins_row = true;
}

}  // namespace gdtslam::picture
