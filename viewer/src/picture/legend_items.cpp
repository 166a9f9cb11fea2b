#include "picture/legend_items.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam::picture {
namespace {

constexpr double kWordsAfter = 0.5;  // of body_px, from a mark to its words
constexpr double kBarPx = 150.0;     // all of one unit
constexpr double kLongestScalePx = 190.0;
constexpr int kBarSteps = 64;

Point2 base_line(const Point2& middle, const Proportions& sizes) {
  return {middle.x(), middle.y() + 0.36 * sizes.body_px};
}

void write(Canvas& canvas, const Point2& left_middle, const std::string& words, const Proportions& sizes) {
  canvas.text(base_line(left_middle, sizes), words, {.size = sizes.body_px});
}

double width_of(const std::string& words, const Proportions& sizes) { return text_width(words, sizes.body_px); }

using DrawMark = void (*)(Canvas&, const Point2&, const PathColours&, const Proportions&);
LegendItem mark_item(const std::string& words, double mark_px, const PathColours& colours, const Proportions& sizes,
                     DrawMark draw_mark) {
  const double indent = mark_px + kWordsAfter * sizes.body_px;
  return {indent + width_of(words, sizes), sizes.body_px,
          [words, mark_px, indent, &colours, sizes, draw_mark](Canvas& canvas, const Point2& left) {
            draw_mark(canvas, {left.x() + 0.5 * mark_px, left.y()}, colours, sizes);
            write(canvas, {left.x() + indent, left.y()}, words, sizes);
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

LegendItem time_item(double seconds, const PathColours& colours, const Proportions& sizes) {
  const std::string start = "start";
  const std::string end = seconds > 0.0 ? "end, after " + duration_text(seconds) : "end";
  const double gap = 18.0 * sizes.unit;
  const double bar = kBarPx * sizes.unit;
  const double before = width_of(start, sizes);
  return {before + bar + 2.0 * gap + width_of(end, sizes), sizes.body_px,
          [=, &colours](Canvas& canvas, const Point2& left) {
            write(canvas, left, start, sizes);
            const Point2 from{left.x() + before + gap, left.y()};
            const Point2 to{from.x() + bar, left.y()};
            draw_bar(canvas, from, bar, 2.0 * sizes.line_px, [&](double share) { return time_colour(colours, share); });
            draw_start(canvas, from, colours, sizes);
            draw_end(canvas, to, colours, sizes);
            write(canvas, {to.x() + gap, to.y()}, end, sizes);
          }};
}

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

double round_length_m(double longest_m) {
  double decade_m = 1e-6;
  while (10.0 * decade_m <= longest_m && decade_m < 1e12) decade_m *= 10.0;
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade_m <= longest_m) return factor * decade_m;
  }
  return decade_m;
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::floor(seconds + 0.5));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

LegendItem scale_bar_item(double px_per_m, const Proportions& sizes) {
  const double length_m = round_length_m(kLongestScalePx * sizes.unit / px_per_m);
  const double length = length_m * px_per_m;
  const std::string words =
      length_m < 0.999 ? fmt::format("{:g} cm", 100.0 * length_m) : fmt::format("{:.0f} m", length_m);
  const double indent = length + kWordsAfter * sizes.body_px;
  return {indent + width_of(words, sizes), sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            const double tall = 0.35 * sizes.body_px;
            const Pen pen{.colour = ink::kText, .width = 2.0 * sizes.unit};
            canvas.polyline({{left.x(), left.y() - tall},
                             {left.x(), left.y() + tall},
                             {left.x() + length, left.y() + tall},
                             {left.x() + length, left.y() - tall}},
                            pen);
            write(canvas, {left.x() + indent, left.y()}, words, sizes);
          }};
}

LegendItem axes_item(const Proportions& sizes) {
  const double arm = 1.5 * sizes.body_px;
  return {arm + 1.6 * sizes.small_px, 1.9 * sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            const Point2 origin{left.x() + 0.2 * sizes.small_px, left.y() + 0.5 * arm};
            const Pen pen{.colour = ink::kText, .width = 1.6 * sizes.unit};
            const double head = 0.28 * sizes.body_px;
            const Point2 x_end = origin + Point2(arm, 0.0);
            const Point2 y_end = origin + Point2(0.0, -arm);
            canvas.polyline({y_end, origin, x_end}, pen);
            canvas.polygon({x_end + Point2(head, 0.0), x_end + Point2(-0.4 * head, -0.6 * head),
                            x_end + Point2(-0.4 * head, 0.6 * head)},
                           Fill{ink::kText});
            canvas.polygon({y_end + Point2(0.0, -head), y_end + Point2(-0.6 * head, 0.4 * head),
                            y_end + Point2(0.6 * head, 0.4 * head)},
                           Fill{ink::kText});
            const Lettering letters{.size = sizes.small_px, .colour = ink::kQuiet};
            canvas.text(x_end + Point2(2.0 * head, 0.3 * sizes.small_px), "x", letters);
            canvas.text(y_end + Point2(1.8 * head, 0.5 * sizes.small_px), "y", letters);
          }};
}

LegendItem swatch_item(const std::string& words, Colour colour, const Proportions& sizes) {
  const double side = 0.95 * sizes.body_px;
  const double indent = side + kWordsAfter * sizes.body_px;
  return {indent + width_of(words, sizes), sizes.body_px, [=](Canvas& canvas, const Point2& left) {
            canvas.rectangle({left.x(), left.y() - 0.5 * side}, side, side, Fill{colour},
                             Pen{.colour = ink::kQuiet, .width = sizes.unit});
            write(canvas, {left.x() + indent, left.y()}, words, sizes);
          }};
}

LegendItem colour_bar_item(const std::string& before, const std::string& after, std::function<Colour(double)> colour_at,
                           const Proportions& sizes) {
  const double gap = kWordsAfter * sizes.body_px;
  const double bar = kBarPx * sizes.unit;
  const double indent = width_of(before, sizes) + gap;
  return {indent + bar + gap + width_of(after, sizes), sizes.body_px,
          [=, colour_at = std::move(colour_at)](Canvas& canvas, const Point2& left) {
            write(canvas, left, before, sizes);
            draw_bar(canvas, {left.x() + indent, left.y()}, bar, 0.8 * sizes.body_px, colour_at);
            write(canvas, {left.x() + indent + bar + gap, left.y()}, after, sizes);
          }};
}

void add_path_items(std::vector<LegendItem>& items, const PathOverlay& overlay, const MapLook& look,
                    const PathColours& colours, const Proportions& sizes) {
  if (look.with_path && !overlay.trajectory.empty()) {
    items.push_back(time_item(duration_s(overlay.trajectory), colours, sizes));
  }
  if (look.with_keyframes && !overlay.keyframes.empty()) {
    items.push_back(
        mark_item(counted(overlay.keyframes.size(), "keyframe"), 0.5 * sizes.body_px, colours, sizes, draw_keyframe));
  }
  if (!overlay.doubtful.empty()) {
    items.push_back(mark_item(counted(overlay.doubtful.size(), "doubtful scan"), 1.1 * sizes.body_px, colours, sizes,
                              draw_doubtful));
  }
}

}  // namespace gdtslam::picture
