#include "plot_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/drawing/maps/map_frame.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kTextPx = 20.0;
constexpr double kMarginPx = 24.0;

}  // namespace

Canvas plot_sheet(const std::string& title, const PictureSize& size, const DrawPlot& draw) {
  const double unit = proportions_of(size).unit;
  const double width = size.width / unit;
  const double height = size.height / unit;
  Canvas canvas(width, height, title.empty() ? "Plot" : title);
  canvas.rectangle({0.0, 0.0}, width, height, Fill{kLightTheme.card});
  draw(canvas, {{kMarginPx, kMarginPx}, width - 2.0 * kMarginPx, height - 2.0 * kMarginPx});
  Canvas page(size.width, size.height, canvas.title());
  page.place(canvas, Point2::Zero(), unit);
  return page;
}

PlotLook plot_look(const std::string& title) { return {.title = title, .text_size = kTextPx}; }

Axis axis_of(const std::string& title, double from, double to, bool is_grown) {
  Axis axis;
  axis.title = title;
  axis.from = from;
  axis.to = to;
  axis.is_grown = is_grown;
  return axis;
}

std::string axis_title(const std::string& quantity, const std::string& unit) {
  return unit.empty() ? quantity : quantity + " (" + unit + ")";
}

std::string value_text(double value, const std::string& unit) {
  const double size = std::fabs(value);
  std::string number = size < 1000.0 ? fmt::format("{:#.3g}", size) : fmt::format("{:.0f}", size);
  if (number.ends_with('.')) number.pop_back();
  // The sign as the axes write it.
  return (value < 0.0 ? "\xE2\x88\x92" : "") + number + (unit.empty() ? "" : " " + unit);
}

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

std::string count_text(const SortedGroup& group) {
  const std::string count = counted(group.values.size(), "value");
  return group.without_value == 0 ? count : fmt::format("{}, {} not finite", count, group.without_value);
}

}  // namespace gdtslam::picture
