// Plots of errors against figures worked out by hand, on axes that are measured from other things in the same plot.
#include <cmath>

#include <gtest/gtest.h>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

constexpr PictureSize kPlotSize{1600, 1200};

/// Pixels to values along one axis, from two places whose values are known.
struct Scale {
  double pixel = 0.0;
  double value = 0.0;
  double per_pixel = 1.0;
  static Scale through(double pixel_a, double value_a, double pixel_b, double value_b) {
    return {pixel_a, value_a, (value_b - value_a) / (pixel_b - pixel_a)};
  }
  [[nodiscard]] double at(double other_pixel) const { return value + (other_pixel - pixel) * per_pixel; }
};

std::vector<shape::Line> lines_in(const Canvas& canvas, Colour colour) {
  std::vector<shape::Line> lines;
  for (const shape::Line& line : shapes_of<shape::Line>(canvas)) {
    if (line.pen.colour == colour) lines.push_back(line);
  }
  return lines;
}

/// Heights of a box's horizontal strokes and edges, from below to above, without doubles.
std::vector<double> levels_of(const Canvas& canvas, Colour colour) {
  std::vector<double> levels;
  for (const shape::Line& line : lines_in(canvas, colour)) {
    for (const Point2& point : line.points) levels.push_back(point.y());
  }
  for (const shape::Rectangle& box : shapes_of<shape::Rectangle>(canvas)) {
    if (!box.fill || !(box.fill->colour == colour)) continue;
    levels.push_back(box.corner.y());
    levels.push_back(box.corner.y() + box.height);
  }
  std::sort(levels.rbegin(), levels.rend());
  levels.erase(std::unique(levels.begin(), levels.end(), [](double a, double b) { return std::fabs(a - b) < 1e-6; }),
               levels.end());
  return levels;
}

/// numpy.percentile([1, 2, 3, 4, 5, 6, 7, 8, 9, 100], [25, 50, 75]) is [3.25, 5.5, 7.75]; whiskers end within
/// 3.25 - 6.75 and 7.75 + 6.75.
TEST(BoxPlot, quartiles_whiskers_and_what_lies_beyond) {
  const ErrorPlot plot{
      "", "error", "m", {{"none", {0, 0, 0, 0}}, {"all", {100, 100}}, {"ten", {9, 8, 7, 6, 5, 100, 4, 3, 2, 1}}}};
  const Canvas canvas = box_plot(plot, kPlotSize);
  const std::vector<double> zero = levels_of(canvas, kLightTheme.curve(0));
  const std::vector<double> hundred = levels_of(canvas, kLightTheme.curve(1));
  ASSERT_EQ(zero.size(), 1U);
  ASSERT_EQ(hundred.size(), 1U);
  const Scale scale = Scale::through(zero[0], 0.0, hundred[0], 100.0);
  const std::vector<double> ten = levels_of(canvas, kLightTheme.curve(2));
  const std::vector<double> expected{1.0, 3.25, 5.5, 7.75, 9.0};
  ASSERT_EQ(ten.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(scale.at(ten[i]), expected[i], 1e-6);
  int beyond = 0;
  for (const shape::Circle& circle : shapes_of<shape::Circle>(canvas)) {
    EXPECT_NEAR(scale.at(circle.centre.y()), 100.0, 1e-6);
    ++beyond;
  }
  EXPECT_EQ(beyond, 1);
  EXPECT_TRUE(says(canvas, "5.50 m"));
  EXPECT_TRUE(says(canvas, "ten (10 values)"));
}

/// Of 1, 2, 2, 5: a quarter up to 1, three quarters up to 2, all up to 5; the median 2, 95 % at 2 + 0.85 * 3 = 4.55.
TEST(DistributionPlot, steps_are_the_shares_of_values) {
  const Canvas canvas = distribution_plot({"", "error", "m", {{"four", {5, 2, 1, 2}}}}, kPlotSize);
  std::vector<Point2> marks;
  for (const shape::Circle& circle : shapes_of<shape::Circle>(canvas)) {
    if (circle.fill && circle.fill->colour == kLightTheme.curve(0)) marks.push_back(circle.centre);
  }
  ASSERT_EQ(marks.size(), 2U);
  const Scale x = Scale::through(marks[0].x(), 2.0, marks[1].x(), 4.55);
  const Scale y = Scale::through(marks[0].y(), 0.5, marks[1].y(), 0.95);
  std::vector<Point2> corners;
  for (const shape::Line& line : lines_in(canvas, kLightTheme.curve(0))) {
    if (line.points.size() > 2) corners = line.points;  // the other one is the legend's
  }
  const std::vector<Point2> expected{{0, 0}, {1, 0}, {1, 0.25}, {2, 0.25}, {2, 0.75}, {5, 0.75}, {5, 1}};
  ASSERT_GE(corners.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(x.at(corners[i].x()), expected[i].x(), 1e-6) << i;
    EXPECT_NEAR(y.at(corners[i].y()), expected[i].y(), 1e-6) << i;
  }
  EXPECT_TRUE(says(canvas, "four: median 2.00 m, 95 % 4.55 m, largest 5.00 m"));
}

TEST(TimePlot, times_are_those_that_people_read) {
  const auto plot = [](double from_s, double to_s) {
    return time_plot("", "error", "m", {{"", {{from_s, 1.0}, {to_s, 2.0}}}}, kPlotSize);
  };
  EXPECT_TRUE(says(plot(3.0, 50.0), "Time (s)"));
  EXPECT_TRUE(says(plot(0.0, 3000.0), "Time (min)"));
  EXPECT_TRUE(says(plot(0.0, 3000.0), "50")) << "minutes at the end of the axis";
  EXPECT_TRUE(says(plot(0.0, 30000.0), "Time (h)"));
  EXPECT_TRUE(says(plot(976052857.0, 976052900.0), "Time since the start (s)")) << "a clock's stamps";
  EXPECT_NO_THROW(rasterise(time_plot("", "error", "m", {}, kPlotSize)));
  EXPECT_NO_THROW(rasterise(plot(1.0, 1.0)));
}

}  // namespace
}  // namespace gdtslam
