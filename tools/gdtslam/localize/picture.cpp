#include "output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_view.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// How a scan is drawn.
enum class Mark : std::uint8_t { kRight, kAmbiguous, kOff, kNone };

Colour colour_of_mark(Mark mark) {
  if (mark == Mark::kRight) return ink::kCoupler;
  return mark == Mark::kAmbiguous ? ink::kLaser : ink::kWarning;
}

Mark mark_of(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.best) return Mark::kNone;
  const bool is_off = scan.reference ? fault_of(scan, limits) != LocalizeFault::kNone
                                     : !scan.is_proven() || scan.verdict == Verdict::kPoorFit;
  if (is_off) return Mark::kOff;
  return scan.is_ambiguous() ? Mark::kAmbiguous : Mark::kRight;
}

// A pose elsewhere that may be as good.
bool has_alternative(const LocalizedScan& scan) { return scan.best && scan.runner_up && scan.is_ambiguous(); }

MapView view_of(const Localizer& localizer, const Localized& all) {
  std::vector<Point2> places;
  places.reserve(3 * all.scans.size());
  for (const LocalizedScan& scan : all.scans) {
    if (scan.best) places.push_back(scan.best->T_map_base.translation());
    if (scan.reference) places.push_back(scan.reference->T_map_base.translation());
    if (has_alternative(scan)) places.push_back(scan.runner_up->T_map_base.translation());
  }
  return view_of_map(localizer.field().file.view(), places);
}

// A slim arrow head whose tail is notched; the pose lies in its middle.
std::vector<Point2> arrow(const Point2& at, double theta_rad, double length) {
  const auto [sin, cos] = sin_cos(theta_rad);
  const Point2 forward(cos, -sin);
  const Point2 left(-sin, -cos);
  return {at + 0.6 * length * forward, at - 0.4 * length * forward + 0.36 * length * left, at - 0.2 * length * forward,
          at - 0.4 * length * forward - 0.36 * length * left};
}

constexpr double kArrow = 12.0;

void draw_arrow(Canvas& canvas, const Point2& at, double theta_rad, Mark mark) {
  std::vector<Point2> outline = arrow(at, theta_rad, mark == Mark::kOff ? 1.25 * kArrow : kArrow);
  canvas.polygon(outline, {colour_of_mark(mark), 0.9});
  outline.push_back(outline.front());
  canvas.polyline(std::move(outline), {.colour = ink::kCard, .width = 0.6, .opacity = 0.9});
}

void draw_hollow(Canvas& canvas, const Point2& at, double theta_rad, const Colour& colour) {
  std::vector<Point2> outline = arrow(at, theta_rad, 1.25 * kArrow);
  outline.push_back(outline.front());
  canvas.polygon({outline.begin(), outline.end() - 1}, {ink::kCard});
  canvas.polyline(std::move(outline), {.colour = colour, .width = 1.4});
}

// Another pose, tied to the one that was found by a dashed line.
void draw_other(Canvas& canvas, const MapView& view, const LocalizedScan& scan, const Pose2& T_map_base, Mark mark) {
  const Colour colour = scan.best ? colour_of_mark(mark) : ink::kText;
  const Point2 at = view.at(T_map_base.translation());
  if (scan.best) {
    canvas.line(view.at(scan.best->T_map_base.translation()), at, {.colour = colour, .width = 1.2, .dashes = "4 3"});
  }
  draw_hollow(canvas, at, T_map_base.theta_rad, colour);
}

/// The indices of scans, one after the other where their places are the same.
struct Name {
  Point2 at;
  std::string words;
  Colour colour;
  int count = 1;
};

void add_name(std::vector<Name>& names, const MapView& view, const LocalizedScan& scan) {
  constexpr double kNear_px = 20.0;
  constexpr double kLetters_px = 12.0;
  constexpr int kMostNamed = 3;
  const Pose2& T = scan.best ? scan.best->T_map_base : scan.reference->T_map_base;
  const Point2 at = view.at(T.translation());
  // Letters would run into each other.
  const auto same = std::find_if(names.begin(), names.end(), [&at](const Name& name) {
    const Point2 off = (at - name.at).cwiseAbs();
    return off.norm() < kNear_px || (off.y() < kLetters_px && off.x() < text_width(name.words, kLetters_px) + 6.0);
  });
  if (same != names.end()) {
    if (++same->count <= kMostNamed) same->words += fmt::format(", {}", scan.index);
    if (same->count == kMostNamed + 1) same->words += ", …";
  } else {
    names.push_back({at, fmt::format("{}", scan.index), scan.best ? ink::kWarning : ink::kText});
  }
}

void draw_name(Canvas& canvas, const MapView& view, const Name& name) {
  const bool is_right = name.at.x() > view.card.corner.x() + 0.85 * view.card.width;
  const bool is_top = name.at.y() < view.card.corner.y() + 30.0;
  canvas.text(name.at + Point2(is_right ? -10.0 : 10.0, is_top ? 18.0 : -8.0), name.words,
              {.size = 12.0,
               .colour = name.colour,
               .anchor = is_right ? Anchor::kEnd : Anchor::kStart,
               .is_bold = true,
               .has_halo = true});
}

// What matters most comes last, on top.
void draw_scans(Canvas& canvas, const MapView& view, const Localized& all, const LocalizeLimits& limits) {
  for (const Mark wanted : {Mark::kRight, Mark::kAmbiguous, Mark::kOff, Mark::kNone}) {
    for (const LocalizedScan& scan : all.scans) {
      if (mark_of(scan, limits) != wanted) continue;
      const bool is_off = wanted == Mark::kOff || wanted == Mark::kNone;
      if (is_off && scan.reference) draw_other(canvas, view, scan, scan.reference->T_map_base, wanted);
      if (wanted == Mark::kAmbiguous && has_alternative(scan)) {
        draw_other(canvas, view, scan, scan.runner_up->T_map_base, wanted);
      }
      if (scan.best)
        draw_arrow(canvas, view.at(scan.best->T_map_base.translation()), scan.best->T_map_base.theta_rad, wanted);
    }
  }
  std::vector<Name> names;
  for (const LocalizedScan& scan : all.scans) {
    const Mark mark = mark_of(scan, limits);
    if (mark == Mark::kOff || (mark == Mark::kNone && scan.reference)) add_name(names, view, scan);
  }
  for (const Name& name : names) draw_name(canvas, view, name);
}

class Legend {
 public:
  Legend(Canvas& canvas, const Point2& at) : canvas_(canvas), at_(at) {}
  void entry(Mark mark, bool is_hollow, const std::string& words) {
    const Point2 place = at_ + Point2(8.0, -4.5);
    if (is_hollow) {
      draw_hollow(canvas_, place, 0.0, mark == Mark::kNone ? ink::kText : colour_of_mark(mark));
    } else {
      draw_arrow(canvas_, place, 0.0, mark);
    }
    canvas_.text(at_ + Point2(24.0, 0.0), words, {.size = 13.0});
    at_.x() += 24.0 + text_width(words, 13.0) + 26.0;
  }

 private:
  Canvas& canvas_;
  Point2 at_;
};

void draw_legend(Canvas& canvas, const Point2& at, const LocalizeJob& job, const Localized& all,
                 const LocalizeLimits& limits) {
  std::array<std::uint64_t, 4> counts{};
  for (const LocalizedScan& scan : all.scans) ++counts[static_cast<std::size_t>(mark_of(scan, limits))];
  const bool has_reference = job.reference.has_value();
  const std::string limit = fmt::format("{:g} cm and {:g}°", 100.0 * limits.within_m, deg_from_rad(limits.within_rad));
  Legend legend(canvas, at);
  legend.entry(Mark::kRight, false,
               has_reference ? fmt::format("within {} of the reference: {}", limit, counts[0])
                             : fmt::format("found: {}", counts[0]));
  if (counts[1] > 0) {
    legend.entry(
        Mark::kAmbiguous, false,
        fmt::format("{}, but a pose elsewhere may be as good: {}", has_reference ? "likewise" : "found", counts[1]));
    if (std::any_of(all.scans.begin(), all.scans.end(), has_alternative)) {
      legend.entry(Mark::kAmbiguous, true, "that pose");
    }
  }
  if (counts[2] > 0) {
    legend.entry(Mark::kOff, false,
                 fmt::format("{}: {}", has_reference ? "not within them" : "a poor fit, or not proven", counts[2]));
    if (has_reference) legend.entry(Mark::kOff, true, "its reference");
  }
  if (counts[3] > 0) legend.entry(Mark::kNone, true, fmt::format("no pose: {}", counts[3]));
}

std::string caption(const LocalizeJob& job, const Localized& all, const LocalizeLimits& limits) {
  const LocalizeFigures figures = figures_of(all.scans, limits);
  std::string text = plural(all.scans.size(), "scan") + ", each searched in the whole map without odometry";
  if (job.choice.random > 0) {
    text = plural(all.scans.size(), "scan") + " at random, each searched in the whole map without odometry";
  }
  if (job.merged) {
    text += "; those " + near_text(*job.merged) + " left out";
  }
  if (figures.within.of == 0) return text;
  return text + fmt::format("; right: {:.1f} % (95 %: {:.1f} to {:.1f} %)", 100.0 * figures.within.value(),
                            100.0 * figures.within.low(), 100.0 * figures.within.high());
}

}  // namespace

Canvas localize_picture(const LocalizeJob& job, const Localizer& localizer, const Localized& all) {
  const LocalizeLimits& limits = localizer.limits();
  const MapView view = view_of(localizer, all);
  const std::string log = std::filesystem::path(job.log).filename().string();
  const std::string title = "Scans of " + log + " found in the map";
  Canvas canvas(page_sizes::kWidth, view.card.corner.y() + view.card.height + page_sizes::kLegend + page_sizes::kMargin,
                title);
  canvas.rectangle({0.0, 0.0}, canvas.width(), canvas.height(), Fill{kLightTheme.page});
  canvas.text({page_sizes::kMargin, page_sizes::kMargin + 18.0}, title, {.size = 20.0, .is_bold = true});
  canvas.text({page_sizes::kMargin, page_sizes::kMargin + 41.0}, caption(job, all, limits),
              {.size = 13.0, .colour = ink::kQuiet});
  const DrawingArea& card = view.card;
  canvas.rectangle(card.corner, card.width, card.height, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, 6.0);
  canvas.begin_clip(card.corner, card.width, card.height);
  draw_walls(canvas, view, localizer.field().file.view());
  draw_scans(canvas, view, all, limits);
  canvas.end_clip();
  draw_scale_bar(canvas, {.pixels_per_m = view.pixels_per_m},
                 card.corner + Point2(page_sizes::kInset, card.height - page_sizes::kInset));
  draw_legend(canvas, card.corner + Point2(0.0, card.height + 28.0), job, all, limits);
  return canvas;
}

}  // namespace gdtslam
