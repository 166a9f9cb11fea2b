// Values over time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "plot_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

/// What the points span; those that are not finite are gaps and span nothing.
struct DataExtent {
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  [[nodiscard]] bool is_empty() const { return !(first_s <= last_s); }
};
DataExtent extent_of(const std::vector<TimeSeries>& series) {
  DataExtent extent;
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

/// Times as people read them.
struct TimeUnit {
  double zero_s = 0.0;
  double length_s = 1.0;
  std::string title;
  [[nodiscard]] double of(double time_s) const { return (time_s - zero_s) / length_s; }
};
TimeUnit time_unit(const DataExtent& extent) {
  constexpr double kClockFrom_s = 1e6;  // later stamps are a clock's, and nobody reads the time of day from them
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

Axis time_axis(const DataExtent& extent, const TimeUnit& unit) {
  Axis axis = axis_of(unit.title, unit.of(extent.first_s), unit.of(extent.last_s), false);
  if (axis.from == axis.to) axis.to = axis.from + 1.0;
  return axis;
}

/// With 0 where it is near: what is half as large then looks so.
Axis value_axis(const DataExtent& extent, const std::string& title) {
  double from = extent.least;
  double to = extent.most;
  if (from > 0.0 && from < 0.5 * to) from = 0.0;
  if (to < 0.0 && to > 0.5 * from) to = 0.0;
  if (from == to) {
    const double half = 0.5 * std::fabs(from);
    from -= half;
    to += half > 0.0 ? half : 1.0;  // nothing but zeros: errors that there are none of
  }
  return axis_of(title, from, to, true);
}

}  // namespace

Canvas time_plot(const std::string& title, const std::string& quantity, const std::string& unit,
                 const std::vector<TimeSeries>& series, const PictureSize& size) {
  const DataExtent extent = extent_of(series);
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
