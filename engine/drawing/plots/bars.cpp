#include "bars.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

namespace gdtslam {
namespace {

constexpr int kBands = 128;

Ticks ticks_along(const ColourBar& bar) {
  const int most = static_cast<int>(std::clamp(bar.length / (4.5 * bar.text_size), 1.0, 8.0));
  return make_ticks(bar.from, bar.to, most, bar.steps);
}

struct BarMark {
  double value = 0.0;
  std::string text;
};

/// An end of the bar, to a fiftieth of its range, without trailing zeros.
BarMark end_mark(double value, double range) {
  constexpr double kShare = 0.02;
  double step = 1.0;
  while (step > kShare * range && step > 1e-9) step /= 10.0;
  while (step * 10.0 <= kShare * range) step *= 10.0;
  std::string text = Ticks{.first = std::floor(value / step + 0.5) * step, .step = step, .count = 1}.text(0);
  if (text.find('.') != std::string::npos && text.find('e') == std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return {value, text};
}

/// Least distance between two marks that keeps their labels apart.
double least_gap(const ColourBar& bar, const BarMark& one, const BarMark& other) {
  const double size = kTickLetters * bar.text_size;
  return 0.5 * (text_width(one.text, size) + text_width(other.text, size)) + 0.6 * size;
}

/// Both ends, and the round values in between that have room.
std::vector<BarMark> bar_marks(const ColourBar& bar) {
  const double range = bar.to - bar.from;
  std::vector<BarMark> marks{end_mark(bar.from, range)};
  const BarMark last = end_mark(bar.to, range);
  const Ticks ticks = ticks_along(bar);
  const auto gap = [&](const BarMark& low, const BarMark& high) {
    return (high.value - low.value) / range * bar.length;
  };
  for (int i = 0; i < ticks.count; ++i) {
    const BarMark mark{ticks.value(i), ticks.text(i)};
    const bool is_free = gap(marks.front(), mark) >= least_gap(bar, marks.front(), mark) &&
                         gap(mark, last) >= least_gap(bar, mark, last);
    if (is_free) marks.push_back(mark);
  }
  marks.push_back(last);
  return marks;
}

double widest(const std::vector<BarMark>& marks, double text_size) {
  double width = 0.0;
  for (const BarMark& mark : marks) width = std::max(width, text_width(mark.text, kTickLetters * text_size));
  return width;
}

double title_room(const ColourBar& bar) { return bar.title.empty() ? 0.0 : 1.7 * bar.text_size; }

/// Room at both ends for half a label, and for rounding to whole pixels.
double end_room(const ColourBar& bar) { return 1.0 + 0.5 * widest(bar_marks(bar), bar.text_size); }

void draw_colours(Canvas& canvas, const ColourBar& bar, const Point2& corner) {
  const double step = bar.length / kBands;
  for (int band = 0; band < kBands; ++band) {
    const Fill fill{bar.map->at((band + 0.5) / kBands)};
    // Each rectangle reaches to the end: the next one covers the rest, without seams.
    canvas.rectangle(corner + Point2(band * step, 0.0), bar.length - band * step, bar.thickness, fill);
  }
}

}  // namespace

DrawingArea colour_bar_room(const ColourBar& bar) {
  const double title = text_width(bar.title, bar.text_size);
  return {Point2::Zero(), std::max(title, bar.length + 2.0 * end_room(bar)),
          title_room(bar) + bar.thickness + kTick_px + 1.4 * bar.text_size};
}

void draw_colour_bar(Canvas& canvas, const ColourBar& bar, const Point2& corner, const Theme& theme) {
  assert(bar.map != nullptr && bar.from < bar.to);
  Lettering title{.size = bar.text_size, .colour = theme.text, .has_halo = bar.has_halo, .halo = theme.page};
  if (!bar.title.empty()) canvas.text(corner + Point2(0.0, bar.text_size), bar.title, title);
  const Point2 place = corner + Point2(end_room(bar), title_room(bar));
  const Point2 start(std::floor(place.x()), std::floor(place.y()));  // whole pixels avoid a blurred rim of colours
  draw_colours(canvas, bar, start);
  canvas.rectangle(start, bar.length, bar.thickness, std::nullopt,
                   Pen{.colour = theme.quiet, .width = 1.0, .opacity = 0.6});
  Lettering letters = title;
  letters.size = kTickLetters * bar.text_size;
  letters.anchor = Anchor::kMiddle;
  for (const BarMark& mark : bar_marks(bar)) {
    const double share = (mark.value - bar.from) / (bar.to - bar.from);
    const Point2 at = start + Point2(bar.length * share, bar.thickness);
    const Point2 end = at + Point2(0.0, kTick_px);
    canvas.line(at, end, {.colour = theme.quiet});
    canvas.text(end + Point2(0.0, 1.2 * letters.size), mark.text, letters);
  }
}

void draw_scale_bar(Canvas& canvas, const ScaleBar& bar, const Point2& start, const Theme& theme) {
  const double length_m = bar.pixels_per_m > 0.0 ? round_length_m(bar.most / bar.pixels_per_m) : 0.0;
  if (!(length_m > 0.0)) return;
  const Point2 end = start + Point2(length_m * bar.pixels_per_m, 0.0);
  const Point2 half_tick(0.0, 0.4 * bar.text_size);
  // Drawn twice, first wider in the page's colour, so that it is visible on any picture.
  for (const bool is_halo : {true, false}) {
    if (is_halo && !bar.has_halo) continue;
    const Pen pen{.colour = is_halo ? theme.page : theme.text, .width = is_halo ? 5.0 : 2.0};
    canvas.line(start, end, pen);
    canvas.line(start - half_tick, start + half_tick, pen);
    canvas.line(end - half_tick, end + half_tick, pen);
  }
  canvas.text(0.5 * (start + end) - Point2(0.0, 0.7 * bar.text_size), length_text(length_m),
              {.size = bar.text_size,
               .colour = theme.text,
               .anchor = Anchor::kMiddle,
               .has_halo = bar.has_halo,
               .halo = theme.page});
}

// Lines are counted in pixels, so a far view costs no more.
void draw_grid(Canvas& canvas, const DrawingArea& area, const Point2& through, double step_px) {
  if (!(step_px > 1.0)) return;
  const Point2 origin = through - area.corner;
  for (double y = std::fmod(origin.y(), step_px); y < area.height; y += step_px) {
    if (y > 0.0) canvas.line(area.corner + Point2(0.0, y), area.corner + Point2(area.width, y), {ink::kGrid});
  }
  for (double x = std::fmod(origin.x(), step_px); x < area.width; x += step_px) {
    if (x > 0.0) canvas.line(area.corner + Point2(x, 0.0), area.corner + Point2(x, area.height), {ink::kGrid});
  }
}

}  // namespace gdtslam
