// Plots of errors by group, as boxes and as distributions, and of values over time, one page each.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/drawing/maps/map_sheet.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {
namespace {

constexpr double kTextPx = 20.0;
constexpr double kMarginPx = 24.0;

/// Draws on a page of natural size, and scales it to the requested size.
Canvas plot_sheet(const std::string& title, const PictureSize& size,
                  const std::function<void(Canvas&, const DrawingArea&)>& draw) {
  const double unit = picture::picture_proportions(size).unit;
  const double width = size.width / unit;
  const double height = size.height / unit;
  Canvas canvas(width, height, title.empty() ? "Plot" : title);
  canvas.rectangle({0.0, 0.0}, width, height, Fill{kLightTheme.card});
  draw(canvas, {{kMarginPx, kMarginPx}, width - 2.0 * kMarginPx, height - 2.0 * kMarginPx});
  Canvas page(size.width, size.height, canvas.title());
  page.place(canvas, Point2::Zero(), unit);
  return page;
}

/// The lettering of every plot on that page.
PlotLook plot_look(const std::string& title) { return {.title = title, .text_size = kTextPx}; }

/// An axis between two values, extended to whole ticks if `is_grown`.
Axis make_axis(const std::string& title, double from, double to, bool is_grown) {
  Axis axis;
  axis.title = title;
  axis.from = from;
  axis.to = to;
  axis.is_grown = is_grown;
  return axis;
}

/// The finite values of a group, ascending, and the number of the others, which is always shown.
struct SortedGroup {
  std::string name;
  std::vector<double> values;
  std::size_t without_value = 0;
};
std::vector<SortedGroup> sorted_groups(const ErrorPlot& plot) {
  std::vector<SortedGroup> groups;
  for (const ErrorGroup& group : plot.groups) {
    SortedGroup sorted{.name = group.name, .values = {}, .without_value = 0};
    for (const double value : group.values) {
      if (std::isfinite(value)) sorted.values.push_back(value);
    }
    sorted.without_value = group.values.size() - sorted.values.size();
    std::sort(sorted.values.begin(), sorted.values.end());
    groups.push_back(std::move(sorted));
  }
  return groups;
}

/// "1,234 values", or with values that are not finite: "1,230 values, 4 not finite".
std::string count_text(const SortedGroup& group) {
  const std::string count = counted(group.values.size(), "value");
  return group.without_value == 0 ? count : fmt::format("{}, {} not finite", count, group.without_value);
}

/// Range of the values' axis: from 0 if no value is negative, so that lengths can be compared.
struct Range {
  double from = 0.0;
  double to = 1.0;
};
Range padded(double least, double most) {
  const double from = std::min(0.0, least);
  const double to = std::max(0.0, most);
  if (from == to) return {0.0, 1.0};
  const double pad = 0.06 * (to - from);
  return {from < 0.0 ? from - pad : 0.0, to > 0.0 ? to + pad : 0.0};
}

/// From whisker to whisker, because a few outliers would flatten all boxes. Each box states their number.
Range value_range(const std::vector<SortedGroup>& groups) {
  double least = 0.0;
  double most = 0.0;
  for (const SortedGroup& group : groups) {
    if (group.values.empty()) continue;
    const BoxFigures figures = box_figures(group.values);
    least = std::min(least, figures.low_whisker);
    most = std::max(most, figures.high_whisker);
  }
  constexpr double kRoom = 0.12;  // for the nearest outliers, and the words that count them
  return padded(least - (least < 0.0 ? kRoom * (most - least) : 0.0), most + kRoom * (most - least));
}

/// "31 beyond, up to 0.0260 m"; empty if the axis covers all.
std::string beyond_text(const std::vector<double>& ascending, double to, const std::string& unit) {
  const auto beyond = ascending.end() - std::upper_bound(ascending.begin(), ascending.end(), to);
  return beyond == 0 ? std::string()
                     : counted(static_cast<std::uint64_t>(beyond), "value") + " beyond, up to " +
                           rounded_text(ascending.back(), unit);
}

/// The value at the frame's upper edge.
double axis_end(const Plot& plot) {
  const double zero = plot.at(0.0, 0.0).y();
  const double one = plot.at(0.0, 1.0).y();
  return (zero - plot.inside().corner.y()) / (zero - one);
}

constexpr double kBoxWidth = 0.44;  // in distances of two boxes

/// Writes the median above the box, as large as the distance of the boxes allows.
void draw_median(Plot& plot, double x, const BoxFigures& figures, const std::string& unit, double text_size) {
  constexpr double kSmallest_px = 7.0;
  const double room = 0.94 * (plot.at(1.0, 0.0).x() - plot.at(0.0, 0.0).x());
  const std::string text = rounded_text(figures.median, unit);
  const double size = std::min(0.9 * text_size, room / text_width(text, 1.0, true));
  if (size < kSmallest_px) return;
  plot.words(x, figures.upper_quartile, text,
             {.size = size, .colour = kLightTheme.text, .anchor = Anchor::kMiddle, .is_bold = true, .has_halo = true},
             {0.0, -0.4 * size});
}

/// "31 beyond, up to 0.0260 m" at the upper edge; shorter if the boxes are close.
void draw_beyond(Plot& plot, double x, const SortedGroup& group, const std::string& unit, double text_size) {
  const double to = axis_end(plot);
  const std::string beyond = beyond_text(group.values, to, unit);
  if (beyond.empty()) return;
  const double room = 0.96 * (plot.at(1.0, 0.0).x() - plot.at(0.0, 0.0).x());
  std::string words = "\u2191 " + beyond;
  if (0.6 * text_size * text_width(words, 1.0) > room) words = "\u2191 " + beyond.substr(0, beyond.find(' '));
  const double size = std::min(0.8 * text_size, room / text_width(words, 1.0));
  plot.words(x, to, words, {.size = size, .colour = kLightTheme.quiet, .anchor = Anchor::kMiddle, .has_halo = true},
             {0.0, 1.3 * text_size + plot.inside().corner.y() - plot.at(x, to).y()});
}

/// Points (value, share of the values up to it).
std::vector<Point2> distribution_steps(const std::vector<double>& ascending, double to) {
  std::vector<Point2> steps{{0.0, 0.0}};
  if (ascending.front() < 0.0) steps.front().x() = ascending.front();
  const auto count = static_cast<double>(ascending.size());
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    // Only the last of several equal values is used.
    if (i + 1 < ascending.size() && ascending[i + 1] == ascending[i]) continue;
    steps.emplace_back(ascending[i], static_cast<double>(i + 1) / count);
  }
  if (steps.back().x() < to) steps.emplace_back(to, 1.0);
  return steps;
}

/// A few outliers would squeeze all curves to the left: the axis ends at three times the largest 95 % mark, and the
/// legend states the largest value.
Range distribution_range(const std::vector<SortedGroup>& groups) {
  double least = 0.0;
  double most = 0.0;
  for (const SortedGroup& group : groups) {
    if (group.values.empty()) continue;
    const double mark = quantile_of_sorted(group.values, 0.95);
    least = std::min(least, group.values.front());
    most = std::max(most, mark > 0.0 ? std::min(group.values.back(), 3.0 * mark) : group.values.back());
  }
  return padded(least, most);
}

void draw_distribution(Plot& plot, const SortedGroup& group, std::size_t number, const std::string& unit, double to) {
  if (group.values.empty()) {
    plot.line({}, {.colour = kLightTheme.curve(number), .width = 2.2}, group.name + ": " + count_text(group));
    return;
  }
  const double median = quantile_of_sorted(group.values, 0.5);
  const double most = quantile_of_sorted(group.values, 0.95);
  const std::string name = group.name + (group.name.empty() ? "" : ": ") + "median " + rounded_text(median, unit) +
                           ", 95 % " + rounded_text(most, unit) + ", largest " +
                           rounded_text(group.values.back(), unit) +
                           (group.without_value == 0 ? "" : ", " + std::to_string(group.without_value) + " not finite");
  plot.steps(distribution_steps(group.values, to), {.colour = kLightTheme.curve(number), .width = 2.2}, name);
  plot.markers(std::array{Point2(median, 0.5), Point2(most, 0.95)}, Fill{kLightTheme.card}, 6.0);
  plot.markers(std::array{Point2(median, 0.5), Point2(most, 0.95)}, Fill{kLightTheme.curve(number)}, 4.5);
}

/// Extent of the points; values that are not finite are ignored.
struct Extent {
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  [[nodiscard]] bool is_empty() const { return !(first_s <= last_s); }
};
Extent find_extent(const std::vector<TimeSeries>& series) {
  Extent extent;
  for (const TimeSeries& one : series) {
    for (const auto& [time_s, value] : one.points) {
      if (!std::isfinite(time_s) || !std::isfinite(value)) continue;
      extent.first_s = std::min(extent.first_s, time_s);
      extent.last_s = std::max(extent.last_s, time_s);
      extent.least = std::min(extent.least, value);
      extent.most = std::max(extent.most, value);
    }
  }
  if (extent.is_empty()) return {0.0, 1.0, 0.0, 1.0};
  return extent;
}

/// Readable unit of times.
struct TimeUnit {
  double zero_s = 0.0;
  double length_s = 1.0;
  std::string title;
  [[nodiscard]] double of(double time_s) const { return (time_s - zero_s) / length_s; }
};
TimeUnit time_unit(const Extent& extent) {
  constexpr double kClockFrom_s = 1e6;  // larger stamps are clock times, shown since the start
  constexpr double kMinute_s = 60.0;
  constexpr double kHour_s = 3600.0;
  TimeUnit unit{
      .zero_s = std::fabs(extent.first_s) >= kClockFrom_s ? extent.first_s : 0.0, .length_s = 1.0, .title = ""};
  const double span_s = extent.last_s - extent.first_s;
  const std::string what = unit.zero_s == 0.0 ? "Time" : "Time since the start";
  if (span_s > 4.0 * kHour_s) {
    unit.length_s = kHour_s;
    unit.title = axis_title(what, "h");
  } else if (span_s > 10.0 * kMinute_s) {
    unit.length_s = kMinute_s;
    unit.title = axis_title(what, "min");
  } else {
    unit.title = axis_title(what, "s");
  }
  return unit;
}

Axis time_axis(const Extent& extent, const TimeUnit& unit) {
  Axis axis = make_axis(unit.title, unit.of(extent.first_s), unit.of(extent.last_s), false);
  if (axis.from == axis.to) axis.to = axis.from + 1.0;
  return axis;
}

/// Includes 0 if it is near: then half the value has half the height.
Axis value_axis(const Extent& extent, const std::string& title) {
  double from = extent.least;
  double to = extent.most;
  if (from > 0.0 && from < 0.5 * to) from = 0.0;
  if (to < 0.0 && to > 0.5 * from) to = 0.0;
  if (from == to) {
    const double half = 0.5 * std::fabs(from);
    from -= half;
    to += half > 0.0 ? half : 1.0;  // all values are zero: no errors
  }
  return make_axis(title, from, to, true);
}

}  // namespace

Canvas box_plot(const ErrorPlot& plot, const PictureSize& size) {
  const std::vector<SortedGroup> groups = sorted_groups(plot);
  return plot_sheet(plot.title, size, [&](Canvas& canvas, const DrawingArea& area) {
    const Range range = value_range(groups);
    Axis x = make_axis("", 0.5, static_cast<double>(std::max<std::size_t>(1, groups.size())) + 0.5, false);
    x.has_grid = false;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      x.names.emplace_back(static_cast<double>(i + 1), groups[i].name);
      x.remarks.push_back(" (" + count_text(groups[i]) + ")");
    }
    const PlotLook look = plot_look(plot.title);
    Plot drawn(canvas, area, x, make_axis(axis_title(plot.quantity, plot.unit), range.from, range.to, true), look);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (groups[i].values.empty()) continue;  // the name says that there are none
      const double at = static_cast<double>(i + 1);
      const BoxFigures figures = box_figures(groups[i].values);
      drawn.box(at, kBoxWidth, figures, kLightTheme.curve(i));
      draw_beyond(drawn, at, groups[i], plot.unit, look.text_size);
      draw_median(drawn, at, figures, plot.unit, look.text_size);
    }
  });
}

Canvas distribution_plot(const ErrorPlot& plot, const PictureSize& size) {
  const std::vector<SortedGroup> groups = sorted_groups(plot);
  return plot_sheet(plot.title, size, [&](Canvas& canvas, const DrawingArea& area) {
    const Range range = distribution_range(groups);
    Plot drawn(canvas, area, make_axis(axis_title(plot.quantity, plot.unit), range.from, range.to, true),
               make_axis("Share of values up to this one", 0.0, 1.0, false), plot_look(plot.title));
    for (const double level : {0.5, 0.95}) {
      drawn.level(level, {.colour = kLightTheme.quiet, .width = 1.0, .dashes = "5 4"});
    }
    for (std::size_t i = 0; i < groups.size(); ++i) {
      // The curve continues beyond the axis, so that the frame cuts it and it does not seem to end.
      const double to = std::max(2.0 * range.to, 1.0);
      draw_distribution(drawn, groups[i], i, plot.unit, to);
    }
    drawn.legend();
  });
}

Canvas time_plot(const std::string& title, const std::string& quantity, const std::string& unit,
                 const std::vector<TimeSeries>& series, const PictureSize& size) {
  const Extent extent = find_extent(series);
  const TimeUnit times = time_unit(extent);
  return plot_sheet(title, size, [&](Canvas& canvas, const DrawingArea& area) {
    Plot plot(canvas, area, time_axis(extent, times), value_axis(extent, axis_title(quantity, unit)), plot_look(title));
    for (std::size_t i = 0; i < series.size(); ++i) {
      std::vector<Point2> points;
      points.reserve(series[i].points.size());
      for (const auto& [time_s, value] : series[i].points) points.emplace_back(times.of(time_s), value);
      plot.line(points, {.colour = kLightTheme.curve(i), .width = 1.6}, series[i].name);
    }
    plot.legend();
  });
}

}  // namespace gdtslam
