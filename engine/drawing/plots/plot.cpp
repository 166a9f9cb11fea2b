#include "gdtslam/drawing/plot.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/core/quantile.hpp"

namespace gdtslam {
namespace {

/// Margin beyond the frame, so that a curve along its edge is not cut in half.
constexpr double kClipMargin_px = 2.0;
constexpr double kCoverStep_px = 6.0;
constexpr std::size_t kMostCovered = 20000;
/// More points than this in one column of pixels are replaced by their extent.
constexpr std::size_t kMostInColumn = 4;

bool is_finite(const Point2& value) { return std::isfinite(value.x()) && std::isfinite(value.y()); }

Point2 bounded(const Point2& place) {
  return {std::clamp(place.x(), -kFarthest_px, kFarthest_px), std::clamp(place.y(), -kFarthest_px, kFarthest_px)};
}

/// Adds the significant points of one column: the first, the lowest and highest in their order, the last.
void add_column(const std::vector<Point2>& points, std::size_t begin, std::size_t end, std::vector<Point2>& kept) {
  if (end - begin <= kMostInColumn) {
    kept.insert(kept.end(), points.begin() + static_cast<std::ptrdiff_t>(begin),
                points.begin() + static_cast<std::ptrdiff_t>(end));
    return;
  }
  const auto first = points.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = points.begin() + static_cast<std::ptrdiff_t>(end);
  const auto [least, most] =
      std::minmax_element(first, last, [](const Point2& one, const Point2& other) { return one.y() < other.y(); });
  std::array chosen{first, std::min(least, most), std::max(least, most), last - 1};
  const auto* const chosen_end = std::unique(chosen.begin(), chosen.end());
  for (const auto* point = chosen.begin(); point != chosen_end; ++point) kept.push_back(**point);
}

/// The same picture with fewer points in crowded columns of pixels.
std::vector<Point2> thinned(const std::vector<Point2>& points) {
  std::vector<Point2> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin + 1;
    while (end < points.size() && std::floor(points[end].x()) == std::floor(points[begin].x())) ++end;
    add_column(points, begin, end, kept);
    begin = end;
  }
  return kept;
}

}  // namespace

BoxFigures box_figures(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  BoxFigures figures;
  figures.lower_quartile = quantile_of_sorted(values, 0.25);
  figures.median = quantile_of_sorted(values, 0.5);
  figures.upper_quartile = quantile_of_sorted(values, 0.75);
  const double reach = 1.5 * (figures.upper_quartile - figures.lower_quartile);
  figures.low_whisker = figures.lower_quartile;
  figures.high_whisker = figures.upper_quartile;
  for (const double value : values) {
    if (value < figures.lower_quartile - reach || value > figures.upper_quartile + reach) {
      figures.beyond.push_back(value);
    } else {
      figures.low_whisker = std::min(figures.low_whisker, value);
      figures.high_whisker = std::max(figures.high_whisker, value);
    }
  }
  return figures;
}

void Plot::begin_clip() {
  canvas_.begin_clip(inside_.corner - Point2(kClipMargin_px, kClipMargin_px), inside_.width + 2.0 * kClipMargin_px,
                     inside_.height + 2.0 * kClipMargin_px);
}

void Plot::cover(const Point2& place) {
  if (covered_.size() < kMostCovered) covered_.push_back(place);
}

void Plot::cover(const Point2& from, const Point2& to) {
  const double length = (to - from).norm();
  const int steps = static_cast<int>(std::min(length / kCoverStep_px, 1000.0)) + 1;
  for (int i = 0; i <= steps; ++i) cover(from + (to - from) * (1.0 * i / steps));
}

void Plot::explain(std::string_view name, Mark mark, const Pen& pen, const Fill& fill) {
  if (!name.empty()) entries_.push_back({std::string(name), mark, pen, fill});
}

void Plot::line(std::span<const Point2> values, const Pen& pen, std::string_view name) {
  explain(name, Mark::kLine, pen, {});
  begin_clip();
  std::vector<Point2> stretch;
  const auto finish = [&] {
    if (stretch.size() == 1) canvas_.circle(stretch.front(), 0.5 * pen.width, Fill{pen.colour, pen.opacity});
    stretch = thinned(stretch);
    for (std::size_t i = 1; i < stretch.size(); ++i) cover(stretch[i - 1], stretch[i]);
    if (stretch.size() > 1) canvas_.polyline(std::move(stretch), pen);
    stretch.clear();
  };
  for (const Point2& value : values) {
    if (is_finite(value)) {
      stretch.push_back(bounded(at(value.x(), value.y())));
    } else {
      finish();
    }
  }
  finish();
  canvas_.end_clip();
}

void Plot::steps(std::span<const Point2> values, const Pen& pen, std::string_view name) {
  std::vector<Point2> corners;
  for (const Point2& value : values) {
    if (!corners.empty() && is_finite(corners.back())) corners.emplace_back(value.x(), corners.back().y());
    corners.push_back(value);
  }
  line(corners, pen, name);
}

void Plot::markers(std::span<const Point2> values, const Fill& fill, double radius, std::string_view name) {
  explain(name, Mark::kDot, {}, fill);
  begin_clip();
  for (const Point2& value : values) {
    if (!is_finite(value)) continue;
    const Point2 place = bounded(at(value.x(), value.y()));
    canvas_.circle(place, radius, fill);
    cover(place);
  }
  canvas_.end_clip();
}

void Plot::band(std::span<const Point2> lower, std::span<const Point2> upper, const Fill& fill, std::string_view name) {
  assert(lower.size() == upper.size());
  explain(name, Mark::kArea, {}, fill);
  begin_clip();
  std::vector<Point2> below;
  std::vector<Point2> above;
  const auto finish = [&] {
    below.insert(below.end(), above.rbegin(), above.rend());
    if (below.size() > 2) canvas_.polygon(below, fill);
    below.clear();
    above.clear();
  };
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (!is_finite(lower[i]) || !is_finite(upper[i])) {
      finish();
      continue;
    }
    below.push_back(bounded(at(lower[i].x(), lower[i].y())));
    above.push_back(bounded(at(upper[i].x(), upper[i].y())));
    cover(below.back());
    cover(above.back());
  }
  finish();
  canvas_.end_clip();
}

void Plot::stretch(double from_x, double to_x, const Fill& fill, std::string_view name) {
  explain(name, Mark::kArea, {}, fill);
  const double from = std::max(at(from_x, 0.0).x(), inside_.corner.x());
  const double to = std::min(at(to_x, 0.0).x(), inside_.corner.x() + inside_.width);
  if (from < to) canvas_.rectangle({from, inside_.corner.y()}, to - from, inside_.height, fill);
}

void Plot::level(double y, const Pen& pen, std::string_view name) {
  line(std::vector<Point2>{{x_.from, y}, {x_.to, y}}, pen, name);
}

void Plot::upright(double x, const Pen& pen, std::string_view name) {
  line(std::vector<Point2>{{x, y_.from}, {x, y_.to}}, pen, name);
}

void Plot::box(double x, double width, const BoxFigures& figures, Colour colour) {
  const Pen thin{.colour = colour, .width = 1.4};
  begin_clip();
  const auto across = [&](double value, double share, const Pen& pen) {
    canvas_.line(at(x - 0.5 * share * width, value), at(x + 0.5 * share * width, value), pen);
  };
  canvas_.line(at(x, figures.low_whisker), at(x, figures.lower_quartile), thin);
  canvas_.line(at(x, figures.upper_quartile), at(x, figures.high_whisker), thin);
  across(figures.low_whisker, 0.5, thin);
  across(figures.high_whisker, 0.5, thin);
  const Point2 corner = at(x - 0.5 * width, figures.upper_quartile);
  const Point2 far = at(x + 0.5 * width, figures.lower_quartile);
  canvas_.rectangle(corner, far.x() - corner.x(), far.y() - corner.y(), Fill{colour, 0.2}, thin);
  across(figures.median, 1.0, {.colour = colour, .width = 3.0});
  cover(at(x, figures.low_whisker), at(x, figures.high_whisker));
  double last_px = std::numeric_limits<double>::infinity();
  for (const double value : figures.beyond) {
    const Point2 place = bounded(at(x, value));
    if (std::fabs(place.y() - last_px) < 1.0) continue;  // hidden behind the one before
    last_px = place.y();
    canvas_.circle(place, 2.2, std::nullopt, Pen{.colour = colour, .width = 1.0, .opacity = 0.8});
    cover(place);
  }
  canvas_.end_clip();
}

void Plot::words(double x, double y, std::string_view text, const Lettering& lettering, const Point2& by) {
  canvas_.text(at(x, y) + by, text, lettering);
}

}  // namespace gdtslam
