#include "plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kLeft = 74.0;
constexpr double kRight = 24.0;
constexpr double kTop = 74.0;
constexpr double kBottom = 52.0;
constexpr double kRadius = 10.0;
constexpr double kSlack = 1e-9;

}  // namespace

PlotScale round_scale(double from, double to) {
  const double span = std::max(to - from, 1e-9);
  double step = 1e-9;
  for (double power = 1e-9; power < 1e12; power *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      step = factor * power;
      if (span / step <= 5.5) {
        return {step * std::floor(from / step + kSlack), step * std::ceil(to / step - kSlack), step};
      }
    }
  }
  return {from, to, step};
}

ScatterPlot::ScatterPlot(Canvas& canvas, PlotFrame frame, std::string_view heading, std::string_view remark)
    : canvas_(canvas), frame_(std::move(frame)), legend_x_(frame_.corner.x() + frame_.width - kRight) {
  canvas_.rectangle(frame_.corner, frame_.width, frame_.height, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, kRadius);
  canvas_.text(frame_.corner + Point2(20.0, 28.0), heading, {.size = 15.0, .is_bold = true});
  canvas_.text(frame_.corner + Point2(20.0, 48.0), remark, {.size = 12.0, .colour = ink::kQuiet});
  const PlotScale& x = frame_.x;
  const PlotScale& y = frame_.y;
  for (double value = y.from; value <= y.to + kSlack * y.step; value += y.step) {
    canvas_.line(at(x.from, value), at(x.to, value), {.colour = ink::kGrid});
    canvas_.text(at(x.from, value) + Point2(-8.0, 4.0), fmt::format("{:g}", std::fabs(value) < kSlack ? 0.0 : value),
                 {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kEnd});
  }
  for (double value = x.from; value <= x.to + kSlack * x.step; value += x.step) {
    canvas_.line(at(value, y.from), at(value, y.from) + Point2(0.0, 4.0), {.colour = ink::kQuiet});
    canvas_.text(at(value, y.from) + Point2(0.0, 18.0), fmt::format("{:g}", std::fabs(value) < kSlack ? 0.0 : value),
                 {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
  }
  canvas_.line(at(x.from, y.from), at(x.to, y.from), {.colour = ink::kQuiet});
  canvas_.text(at(0.5 * (x.from + x.to), y.from) + Point2(0.0, 37.0), frame_.x_name,
               {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
  canvas_.upright_text({frame_.corner.x() + 22.0, at(x.from, 0.5 * (y.from + y.to)).y()}, frame_.y_name,
                       {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
}

Point2 ScatterPlot::at(double x, double y) const {
  const double width = frame_.width - kLeft - kRight;
  const double height = frame_.height - kTop - kBottom;
  return frame_.corner + Point2(kLeft + width * (x - frame_.x.from) / (frame_.x.to - frame_.x.from),
                                kTop + height * (frame_.y.to - y) / (frame_.y.to - frame_.y.from));
}

bool ScatterPlot::holds(double x, double y) const {
  return x >= frame_.x.from && x <= frame_.x.to && y >= frame_.y.from && y <= frame_.y.to;
}

void ScatterPlot::dot(double x, double y, Colour colour, double radius) {
  if (holds(x, y)) canvas_.circle(at(x, y), radius, Fill{colour});
}

void ScatterPlot::curve(const std::vector<Point2>& points, const Pen& pen) {
  std::vector<Point2> part;
  const auto finish = [&] {
    if (part.size() > 1) canvas_.polyline(part, pen);
    part.clear();
  };
  for (const Point2& point : points) {
    if (holds(point.x(), point.y())) {
      part.push_back(at(point.x(), point.y()));
    } else {
      finish();
    }
  }
  finish();
}

void ScatterPlot::level(double y, const Pen& pen) { canvas_.line(at(frame_.x.from, y), at(frame_.x.to, y), pen); }

void ScatterPlot::band(double from_y, double to_y, Colour fill) {
  const Point2 corner = at(frame_.x.from, std::min(to_y, frame_.y.to));
  const Point2 end = at(frame_.x.to, std::max(from_y, frame_.y.from));
  canvas_.rectangle(corner, end.x() - corner.x(), end.y() - corner.y(), Fill{fill});
}

void ScatterPlot::legend(Colour colour, bool is_line, std::string_view words) {
  constexpr double kSize = 12.0;
  const double y = frame_.corner.y() + 24.0;
  canvas_.text({legend_x_, y + 4.0}, words, {.size = kSize, .colour = ink::kQuiet, .anchor = Anchor::kEnd});
  legend_x_ -= text_width(words, kSize) + 10.0;
  if (is_line) {
    canvas_.line({legend_x_ - 18.0, y}, {legend_x_, y}, {.colour = colour, .width = 2.5});
  } else {
    canvas_.circle({legend_x_ - 6.0, y}, 4.0, Fill{colour});
  }
  legend_x_ -= 32.0;
}

}  // namespace gdtslam
