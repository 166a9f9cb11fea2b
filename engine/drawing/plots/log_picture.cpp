#include "log_picture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "bars.hpp"
#include "engine/drawing/letters.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "plot_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

// Pixels of the page in its natural size.
constexpr double kPanelPx = 214.0;
constexpr double kHeadPx = 84.0;
constexpr double kFootPx = 44.0;
constexpr double kLettersPx = 18.0;
constexpr double kTitlesPx = 30.0;  // room for the upright titles
constexpr double kCurvePx = 1.6;
constexpr int kMostTimeTicks = 10;
constexpr std::uint32_t kWidthPx = 1600;
constexpr double kKeysPx = 18.0;  // room for them above a frame, beside the usual
constexpr double kLineKeyPx = 2.5;
constexpr Fill kGapFill{.colour = ink::kWarning, .opacity = 0.16};

/// What a colour of a panel means.
struct PanelKey {
  std::string name;
  Fill fill;
  double height = 12.0;  ///< of its sample
};

/// One of the plots: its axis, what it draws, and what its colours mean.
struct LogPanel {
  std::string title;
  double from = 0.0;
  double to = 1.0;
  bool is_grown = true;
  std::vector<PanelKey> keys{};
  std::function<void(Plot&)> draw{};
};

/// Seconds, minutes or hours, as people read the time of a log.
struct LogTimes {
  double unit_s = 1.0;
  const char* title = "Time since the first scan (s)";
  double end = 1.0;  ///< in that unit
  [[nodiscard]] Point2 operator()(const Point2& value) const { return {value.x() / unit_s, value.y()}; }
};
LogTimes times_of(const LogPicture& log) {
  constexpr double kMinute_s = 60.0;
  constexpr double kHour_s = 3600.0;
  LogTimes times;
  const double length_s = log.length;
  if (!log.is_by_time) {
    times.title = "Number of the scan";
  } else if (length_s > 4.0 * kHour_s) {
    times = {.unit_s = kHour_s, .title = "Time since the first scan (h)"};
  } else if (length_s > 10.0 * kMinute_s) {
    times = {.unit_s = kMinute_s, .title = "Time since the first scan (min)"};
  }
  times.end = length_s > 0.0 ? length_s / times.unit_s : 1.0;
  return times;
}

std::vector<Point2> timed(const std::vector<Point2>& values, const LogTimes& times) {
  std::vector<Point2> moved;
  moved.reserve(values.size());
  for (const Point2& value : values) moved.push_back(times(value));
  return moved;
}

double largest(const std::vector<Point2>& values) {
  double most = 0.0;
  for (const Point2& value : values) {
    if (std::isfinite(value.y())) most = std::max(most, std::fabs(value.y()));
  }
  return most > 0.0 ? most : 1.0;
}

void mark_gaps(Plot& plot, const LogPicture& log, const LogTimes& times) {
  for (const auto& [from_s, to_s] : log.gaps_s) plot.stretch(from_s / times.unit_s, to_s / times.unit_s, kGapFill);
}

LogPanel rate_panel(const LogPicture& log, const LogTimes& times) {
  LogPanel panel{.title = "Scans (1/s)", .to = 1.05 * largest(log.rates_hz)};
  if (!log.gaps_s.empty()) panel.keys = {{"no scans", kGapFill}};
  panel.draw = [&log, times](Plot& plot) {
    mark_gaps(plot, log, times);
    plot.steps(timed(log.rates_hz, times), {.colour = kLightTheme.curve(0), .width = kCurvePx});
  };
  return panel;
}

LogPanel speed_panel(const LogPicture& log, const LogTimes& times) {
  LogPanel panel{.title = "Speed (m/s)", .to = 1.05 * largest(log.speeds_m_s)};
  if (!log.jumps_s.empty()) panel.keys = {{"jump of the odometry", {.colour = kLightTheme.warning}, kLineKeyPx}};
  panel.draw = [&log, times](Plot& plot) {
    mark_gaps(plot, log, times);
    for (const double at_s : log.jumps_s) {
      plot.upright(at_s / times.unit_s, {.colour = kLightTheme.warning, .width = 1.2, .dashes = "4 3"});
    }
    plot.line(timed(log.speeds_m_s, times), {.colour = kLightTheme.curve(2), .width = kCurvePx});
  };
  return panel;
}

LogPanel turn_panel(const LogPicture& log, const LogTimes& times) {
  const double most = 1.05 * largest(log.turns_deg_s);
  LogPanel panel{.title = "Turning (°/s)", .from = -most, .to = most};
  panel.draw = [&log, times](Plot& plot) {
    mark_gaps(plot, log, times);
    plot.level(0.0, {.colour = kLightTheme.quiet, .width = 1.0, .opacity = 0.7});
    plot.line(timed(log.turns_deg_s, times), {.colour = kLightTheme.curve(3), .width = kCurvePx});
  };
  return panel;
}

LogPanel elevation_panel(const LogPicture& log, const LogTimes& times) {
  std::vector<Point2> least;
  std::vector<Point2> most;
  least.reserve(log.elevations_deg.size());
  most.reserve(log.elevations_deg.size());
  for (const auto& [low, high] : log.elevations_deg) {
    least.push_back(times(low));
    most.push_back(times(high));
  }
  const double far = 1.05 * std::max(largest(least), largest(most));
  LogPanel panel{.title = "Elevation (°)", .from = -far, .to = far};
  panel.draw = [least, most](Plot& plot) {
    plot.band(least, most, {.colour = kLightTheme.curve(5), .opacity = 0.35});
    plot.line(least, {.colour = kLightTheme.curve(5), .width = 1.0});
    plot.line(most, {.colour = kLightTheme.curve(5), .width = 1.0});
  };
  return panel;
}

LogPanel range_panel(const LogPicture& log, const LogTimes& times) {
  constexpr double kOuter = 0.16;
  constexpr double kInner = 0.3;
  const Colour colour = kLightTheme.curve(0);
  double most_m = 0.0;
  for (const LogPicture::Ranges& ranges : log.ranges) {
    if (std::isfinite(ranges.most_m)) most_m = std::max(most_m, ranges.most_m);
  }
  const auto curve = [&log, times](double LogPicture::Ranges::*value) {
    std::vector<Point2> points;
    points.reserve(log.ranges.size());
    for (const LogPicture::Ranges& ranges : log.ranges) points.push_back(times({ranges.time_s, ranges.*value}));
    return points;
  };
  LogPanel panel{.title = "Ranges (m)", .to = most_m > 0.0 ? 1.05 * most_m : 1.0};
  panel.keys = {{"nine of ten returns", {.colour = colour, .opacity = kOuter}},
                {"half of them", {.colour = colour, .opacity = 1.0 - (1.0 - kOuter) * (1.0 - kInner)}},
                {"median", {.colour = colour}, kLineKeyPx}};
  panel.draw = [&log, times, curve, colour](Plot& plot) {
    using Ranges = LogPicture::Ranges;
    mark_gaps(plot, log, times);
    plot.band(curve(&Ranges::least_m), curve(&Ranges::most_m), {.colour = colour, .opacity = kOuter});
    plot.band(curve(&Ranges::lower_m), curve(&Ranges::upper_m), {.colour = colour, .opacity = kInner});
    plot.line(curve(&Ranges::median_m), {.colour = colour, .width = kCurvePx});
  };
  return panel;
}

LogPanel missing_panel(const LogPicture& log, const LogTimes& times) {
  LogPanel panel{.title = "No return (%)", .to = 100.0, .is_grown = false};
  panel.draw = [&log, times](Plot& plot) {
    mark_gaps(plot, log, times);
    plot.line(timed(log.missing_percent, times), {.colour = kLightTheme.curve(1), .width = kCurvePx});
  };
  return panel;
}

std::vector<LogPanel> panels_of(const LogPicture& log, const LogTimes& times) {
  std::vector<LogPanel> panels;
  if (!log.rates_hz.empty()) panels.push_back(rate_panel(log, times));
  if (!log.speeds_m_s.empty()) {
    panels.push_back(speed_panel(log, times));
    panels.push_back(turn_panel(log, times));
  }
  if (!log.elevations_deg.empty()) panels.push_back(elevation_panel(log, times));
  panels.push_back(range_panel(log, times));
  panels.push_back(missing_panel(log, times));
  return panels;
}

Axis value_axis(const LogPanel& panel) { return axis_of("", panel.from, panel.to, panel.is_grown); }

/// Ticks with or without their labels; the grid is drawn apart, as axes with named places have none.
Axis time_axis(const LogTimes& times, const Ticks& ticks, bool is_labelled) {
  Axis axis = axis_of("", 0.0, times.end, false);
  for (int k = 0; k < ticks.count; ++k) axis.names.emplace_back(ticks.value(k), is_labelled ? ticks.text(k) : "");
  return axis;
}

void draw_head(Canvas& canvas, const LogPicture& log, const DrawingArea& area) {
  canvas.text(area.corner + Point2(0.0, 28.0), shortened(log.title, 28.0, area.width, true),
              {.size = 28.0, .colour = kLightTheme.text, .is_bold = true});
  canvas.text(area.corner + Point2(0.0, 58.0), shortened(log.subtitle, kLettersPx, area.width),
              {.size = kLettersPx, .colour = kLightTheme.quiet});
}

// Above the frame, from its right end.
void draw_keys(Canvas& canvas, const LogPanel& panel, const DrawingArea& inside) {
  constexpr double kSamplePx = 26.0;
  constexpr double kSize = kTickLetters * kLettersPx;
  const double line = inside.corner.y() - 7.0;
  double right = inside.corner.x() + inside.width;
  for (auto key = panel.keys.rbegin(); key != panel.keys.rend(); ++key) {
    canvas.text({right, line}, key->name, {.size = kSize, .colour = kLightTheme.quiet, .anchor = Anchor::kEnd});
    right -= text_width(key->name, kSize) + 8.0 + kSamplePx;
    const double middle = line - kHalfFigure * kSize;
    canvas.rectangle({right, middle - 0.5 * key->height}, kSamplePx, key->height, key->fill);
    right -= 22.0;
  }
}

/// Where the frame of a panel is within its room, which the keys share.
DrawingArea frame_of(const LogPanel& panel, const DrawingArea& room, const Axis& time) {
  Canvas scratch(room.width, room.height, "");
  const double above = panel.keys.empty() ? 0.0 : kKeysPx;
  const DrawingArea area{{0.0, above}, room.width, room.height - above};
  return Plot(scratch, area, time, value_axis(panel), {.text_size = kLettersPx}).inside();
}

void draw_panel(Canvas& canvas, const LogPanel& panel, const DrawingArea& area, const LogTimes& times, bool is_last) {
  const PlotLook look{.text_size = kLettersPx};
  const Ticks ticks = ticks_of(0.0, times.end, kMostTimeTicks);
  Plot plot(canvas, area, time_axis(times, ticks, is_last), value_axis(panel), look);
  const DrawingArea& inside = plot.inside();
  for (int t = 0; t < ticks.count; ++t) {
    const double x = std::floor(plot.at(ticks.value(t), 0.0).x()) + 0.5;
    canvas.line({x, inside.corner.y()}, {x, inside.corner.y() + inside.height}, {.colour = kLightTheme.grid});
  }
  panel.draw(plot);
  draw_keys(canvas, panel, inside);
}

}  // namespace

PictureSize size_of_log_picture(const LogPicture& log) {
  const auto panels = static_cast<double>(panels_of(log, times_of(log)).size());
  return {.width = kWidthPx, .height = static_cast<std::uint32_t>(kHeadPx + kFootPx + panels * kPanelPx + 48.0)};
}

Canvas log_picture(const LogPicture& log, const PictureSize& size) {
  const LogTimes times = times_of(log);
  const std::vector<LogPanel> panels = panels_of(log, times);
  const Axis time = time_axis(times, ticks_of(0.0, times.end, kMostTimeTicks), true);
  return plot_sheet(log.title, size, [&](Canvas& canvas, const DrawingArea& page) {
    draw_head(canvas, log, page);
    const double height = (page.height - kHeadPx - kFootPx) / static_cast<double>(panels.size());
    // Below a panel without labels its room for them is given to the next one.
    DrawingArea area{page.corner + Point2(kTitlesPx, kHeadPx), page.width - kTitlesPx, height + 1.4 * kLettersPx};
    double left = 0.0;
    for (const LogPanel& panel : panels) left = std::max(left, frame_of(panel, area, time).corner.x());
    for (const LogPanel& panel : panels) {
      const DrawingArea frame = frame_of(panel, area, time);
      const double behind = left - frame.corner.x();
      const double above = panel.keys.empty() ? 0.0 : kKeysPx;
      const DrawingArea below_keys{area.corner + Point2(behind, above), area.width - behind, area.height - above};
      draw_panel(canvas, panel, below_keys, times, &panel == &panels.back());
      const double middle = area.corner.y() + frame.corner.y() + 0.5 * frame.height;
      canvas.upright_text({page.corner.x() + kLettersPx, middle}, panel.title,
                          {.size = kLettersPx, .colour = kLightTheme.text, .anchor = Anchor::kMiddle});
      area.corner.y() += height;
    }
    canvas.text({page.corner.x() + 0.5 * (page.width + kTitlesPx + left), page.corner.y() + page.height - 4.0},
                times.title, {.size = kLettersPx, .colour = kLightTheme.text, .anchor = Anchor::kMiddle});
  });
}

}  // namespace gdtslam
