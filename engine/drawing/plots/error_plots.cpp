// Errors by group: as boxes and as distributions.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/core/quantile.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "plot_sheet.hpp"

namespace gdtslam {
namespace {

using namespace picture;

/// From where to where the values' axis goes: from 0 where nothing is below it, so that lengths can be compared.
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

/// From whisker to whisker: a few values far out would press all boxes to the floor. Each box tells how many they are.
Range range_of(const std::vector<SortedGroup>& groups) {
  double least = 0.0;
  double most = 0.0;
  for (const SortedGroup& group : groups) {
    if (group.values.empty()) continue;
    const BoxFigures figures = box_figures(group.values);
    least = std::min(least, figures.low_whisker);
    most = std::max(most, figures.high_whisker);
  }
  constexpr double kRoom = 0.12;  // for the nearest of those beyond, and the words that count them
  return padded(least - (least < 0.0 ? kRoom * (most - least) : 0.0), most + kRoom * (most - least));
}

/// "31 beyond, up to 0.0260 m"; nothing where the axis holds all.
std::string beyond_text(const std::vector<double>& ascending, double to, const std::string& unit) {
  const auto beyond = ascending.end() - std::upper_bound(ascending.begin(), ascending.end(), to);
  return beyond == 0 ? std::string()
                     : counted(static_cast<std::uint64_t>(beyond), "value") + " beyond, up to " +
                           value_text(ascending.back(), unit);
}

/// The value at the frame's upper edge.
double axis_end(const Plot& plot) {
  const double zero = plot.at(0.0, 0.0).y();
  const double one = plot.at(0.0, 1.0).y();
  return (zero - plot.inside().corner.y()) / (zero - one);
}

constexpr double kBoxWidth = 0.44;  // of the distance of two boxes

/// How the medians are written: beside the boxes where all find room there, else above them.
struct MedianWords {
  bool is_beside = true;
  double size = 0.0;
  std::string unit = {};
};

MedianWords median_words(const Plot& plot, const std::vector<SortedGroup>& groups, const std::string& unit,
                         double text_size) {
  constexpr double kShare = 0.9;
  const double distance = plot.at(1.0, 0.0).x() - plot.at(0.0, 0.0).x();
  const double gap = 0.4 * text_size;
  const auto widest = [&](const std::string& of) {
    double width = 0.0;
    for (const SortedGroup& group : groups) {
      if (group.values.empty()) continue;
      width = std::max(width, text_width(value_text(quantile_of_sorted(group.values, 0.5), of), 1.0, true));
    }
    return width;
  };
  // The last one has the way to the frame.
  const double room = (0.5 - 0.5 * kBoxWidth) * distance - gap;
  if (kShare * text_size * widest(unit) <= room) return {true, kShare * text_size, unit};
  const double least = 0.6 * text_size;
  const double with_unit = 0.94 * distance / std::max(widest(unit), 1e-9);
  if (with_unit >= least) return {false, std::min(kShare * text_size, with_unit), unit};
  return {false, std::min(kShare * text_size, 0.94 * distance / std::max(widest(""), 1e-9)), ""};
}

void draw_median(Plot& plot, double x, const BoxFigures& figures, const MedianWords& words, double text_size) {
  constexpr double kSmallest_px = 7.0;
  if (words.size < kSmallest_px) return;
  const Lettering letters{.size = words.size,
                          .colour = kLightTheme.text,
                          .anchor = words.is_beside ? Anchor::kStart : Anchor::kMiddle,
                          .is_bold = true,
                          .has_halo = true};
  const std::string text = value_text(figures.median, words.unit);
  if (words.is_beside) {
    plot.words(x + 0.5 * kBoxWidth, figures.median, text, letters, {0.4 * text_size, 0.34 * text_size});
  } else {
    plot.words(x, figures.upper_quartile, text, letters, {0.0, -0.4 * words.size});
  }
}

/// "31 beyond, up to 0.0260 m" at the upper edge; in fewer words where the boxes are close.
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

void draw_box(Plot& plot, double x, const SortedGroup& group, std::size_t number, const std::string& unit,
              const MedianWords& words, double text_size) {
  if (group.values.empty()) return;  // its name says so
  const BoxFigures figures = box_figures(group.values);
  plot.box(x, kBoxWidth, figures, kLightTheme.curve(number));
  draw_beyond(plot, x, group, unit, text_size);
  draw_median(plot, x, figures, words, text_size);
}

/// Value and share of the values up to it.
std::vector<Point2> distribution_of(const std::vector<double>& ascending, double to) {
  std::vector<Point2> steps{{0.0, 0.0}};
  if (ascending.front() < 0.0) steps.front().x() = ascending.front();
  const auto count = static_cast<double>(ascending.size());
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    // Of equal values the last one counts.
    if (i + 1 < ascending.size() && ascending[i + 1] == ascending[i]) continue;
    steps.emplace_back(ascending[i], static_cast<double>(i + 1) / count);
  }
  if (steps.back().x() < to) steps.emplace_back(to, 1.0);
  return steps;
}

/// A few values far out would press all curves to the left edge: the axis ends at three times the largest 95 % mark,
/// and the legend tells the largest value.
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
  const std::string name = group.name + (group.name.empty() ? "" : ": ") + "median " + value_text(median, unit) +
                           ", 95 % " + value_text(most, unit) + ", largest " + value_text(group.values.back(), unit) +
                           (group.without_value == 0 ? "" : ", " + std::to_string(group.without_value) + " not finite");
  plot.steps(distribution_of(group.values, to), {.colour = kLightTheme.curve(number), .width = 2.2}, name);
  plot.markers(std::array{Point2(median, 0.5), Point2(most, 0.95)}, Fill{kLightTheme.card}, 6.0);
  plot.markers(std::array{Point2(median, 0.5), Point2(most, 0.95)}, Fill{kLightTheme.curve(number)}, 4.5);
}

}  // namespace

Canvas box_plot(const ErrorPlot& plot, const PictureSize& size) {
  const std::vector<SortedGroup> groups = sorted_groups(plot);
  return plot_sheet(plot.title, size, [&](Canvas& canvas, const DrawingArea& area) {
    const Range range = range_of(groups);
    Axis x = axis_of("", 0.5, static_cast<double>(std::max<std::size_t>(1, groups.size())) + 0.5, false);
    x.has_grid = false;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      x.names.emplace_back(static_cast<double>(i + 1), groups[i].name);
      x.remarks.push_back(" (" + count_text(groups[i]) + ")");
    }
    const PlotLook look = plot_look(plot.title);
    Plot drawn(canvas, area, x, axis_of(axis_title(plot.quantity, plot.unit), range.from, range.to, true), look);
    const MedianWords words = median_words(drawn, groups, plot.unit, look.text_size);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      draw_box(drawn, static_cast<double>(i + 1), groups[i], i, plot.unit, words, look.text_size);
    }
  });
}

Canvas distribution_plot(const ErrorPlot& plot, const PictureSize& size) {
  const std::vector<SortedGroup> groups = sorted_groups(plot);
  return plot_sheet(plot.title, size, [&](Canvas& canvas, const DrawingArea& area) {
    const Range range = distribution_range(groups);
    Plot drawn(canvas, area, axis_of(axis_title(plot.quantity, plot.unit), range.from, range.to, true),
               axis_of("Share of values up to this one", 0.0, 1.0, false), plot_look(plot.title));
    for (const double level : {0.5, 0.95}) {
      drawn.level(level, {.colour = kLightTheme.quiet, .width = 1.0, .dashes = "5 4"});
    }
    for (std::size_t i = 0; i < groups.size(); ++i) {
      // Beyond the axis the curve goes on, so that it is cut by the frame and does not end.
      const double to = std::max(2.0 * range.to, 1.0);
      draw_distribution(drawn, groups[i], i, plot.unit, to);
    }
    drawn.legend();
  });
}

}  // namespace gdtslam
