// Plots: every word within its area, none over another, values where linear scales put them.
#include "gdtslam/drawing/plot.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

using test::expect_tidy;
using test::shapes_of;

TEST(Plot, AnyRangeInAnySizeIsTidy) {
  for (const double text_size : {9.0, 13.0, 22.0}) {
    for (const double width : {260.0, 400.0, 900.0}) {
      for (const auto& [from, to] : {std::pair{0.0, 1.0},
                                     {-1234567.0, 7654321.0},
                                     {0.99991, 1.00002},
                                     {3.0, 3.0},
                                     {0.0, 1e-7},
                                     {-3e12, 4e12},
                                     {kNone, 1.0},
                                     {5.0, -5.0}}) {
        for (const bool is_grown : {false, true}) {
          const DrawingArea area{{40, 30}, width, 0.7 * width};
          Canvas canvas(1000, 800, "");
          const Axis axis{.title = "value in m", .from = from, .to = to, .is_grown = is_grown};
          const Plot plot(canvas, area, axis, axis, {.title = "Title", .text_size = text_size});
          expect_tidy(canvas, area);
          EXPECT_GT(shapes_of<shape::Words>(canvas).size(), 4U) << from << " to " << to;
        }
      }
    }
  }
}

TEST(Plot, NamesOfGroupsTakeTwoRowsBeforeTheyAreCut) {
  const std::vector<std::pair<double, std::string>> names{
      {1, "simplex"}, {2, "gauss-newton"}, {3, "exhaustive"}, {4, "certified"}};
  for (const double width : {200.0, 320.0, 800.0}) {
    const DrawingArea area{{10, 10}, width, 200};
    Canvas canvas(900, 300, "");
    const Plot plot(canvas, area, {.from = 0.5, .to = 4.5, .names = names}, {.title = "error in m"});
    expect_tidy(canvas, area);
  }
  Canvas canvas(900, 300, "");
  const Plot plot(canvas, {{10, 10}, 320, 200}, {.from = 0.5, .to = 4.5, .names = names}, {});
  int whole = 0;
  for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
    for (const auto& [value, name] : names) whole += words.text == name ? 1 : 0;
  }
  EXPECT_EQ(whole, 4);
}

TEST(Plot, WhatIsNotFiniteLeavesAGap) {
  Canvas canvas(500, 400, "");
  Plot plot(canvas, {{0, 0}, 500, 400}, {.to = 4}, {});
  const std::size_t before = shapes_of<shape::Line>(canvas).size();
  plot.line(std::vector<Point2>{{0, 0.5}, {1, 0.6}, {2, kNone}, {3, 0.4}, {4, 0.1}}, {});
  const std::vector<shape::Line> lines = shapes_of<shape::Line>(canvas);
  ASSERT_EQ(lines.size(), before + 2);
  EXPECT_TRUE(lines[before].points.back().isApprox(plot.at(1, 0.6)));
  EXPECT_TRUE(lines[before + 1].points.front().isApprox(plot.at(3, 0.4)));
}

TEST(Plot, AMillionValuesKeepTheirExtremes) {
  Canvas canvas(500, 400, "");
  Plot plot(canvas, {{0, 0}, 500, 400}, {.to = 1e6}, {.from = -1, .to = 1});
  std::vector<Point2> values;
  for (int i = 0; i < 1000000; ++i) values.emplace_back(i, i == 654321 ? 0.9 : 0.1 * (i % 7) / 7.0);
  plot.line(values, {});
  const std::vector<Point2> drawn = shapes_of<shape::Line>(canvas).back().points;
  EXPECT_LT(drawn.size(), 4U * 500U);
  EXPECT_TRUE(drawn.front().isApprox(plot.at(0, 0)));
  EXPECT_TRUE(drawn.back().isApprox(plot.at(999999, values.back().y())));
  double highest = 1e9;
  for (const Point2& point : drawn) highest = std::min(highest, point.y());
  EXPECT_NEAR(highest, plot.at(0, 0.9).y(), 1e-9);
  for (std::size_t i = 1; i < drawn.size(); ++i) EXPECT_LE(drawn[i - 1].x(), drawn[i].x());
}

TEST(Plot, TheLegendKeepsOffTheCurve) {
  for (const bool is_high_at_left : {true, false}) {
    Canvas canvas(600, 400, "");
    Plot plot(canvas, {{0, 0}, 600, 400}, {}, {});
    plot.line(std::vector<Point2>{{0.0, is_high_at_left ? 1.0 : 0.0}, {1.0, is_high_at_left ? 0.0 : 1.0}}, {},
              "a curve");
    plot.legend();
    const shape::Rectangle card = shapes_of<shape::Rectangle>(canvas).back();
    for (double x = 0.0; x <= 1.0; x += 0.01) {
      const Point2 at = plot.at(x, is_high_at_left ? 1.0 - x : x);
      EXPECT_FALSE(at.x() > card.corner.x() && at.x() < card.corner.x() + card.width && at.y() > card.corner.y() &&
                   at.y() < card.corner.y() + card.height);
    }
  }
  Canvas canvas(600, 400, "");
  Plot plot(canvas, {{0, 0}, 600, 400}, {}, {});
  plot.line(std::vector<Point2>{{0, 0}, {1, 1}}, {});
  const std::size_t shapes = canvas.shapes().size();
  plot.legend();  // nothing has a name
  EXPECT_EQ(canvas.shapes().size(), shapes);
}

TEST(BoxFigures, AreTukeysWithQuartilesBetweenValues) {  // R: quantile(c(1:9, 14.6)); 7.75 + 1.5 * 4.5 = 14.5
  const BoxFigures figures = box_figures({9, 2, 7, 4, 14.6, 5, 3, 6, 1, 8});
  EXPECT_DOUBLE_EQ(figures.lower_quartile, 3.25);
  EXPECT_DOUBLE_EQ(figures.median, 5.5);
  EXPECT_DOUBLE_EQ(figures.upper_quartile, 7.75);
  EXPECT_EQ(figures.low_whisker, 1.0);
  EXPECT_EQ(figures.high_whisker, 9.0);
  EXPECT_THAT(figures.beyond, testing::ElementsAre(14.6));
  EXPECT_EQ(box_figures({9, 2, 7, 4, 14.4, 5, 3, 6, 1, 8}).high_whisker, 14.4);
  const BoxFigures one = box_figures({3.0});
  EXPECT_EQ(one.low_whisker, 3.0);
  EXPECT_EQ(one.median, 3.0);
  EXPECT_EQ(one.high_whisker, 3.0);
}

TEST(ColourBar, HasItsColoursItsTicksAndItsRoom) {
  Canvas canvas(600, 600, "");
  const ColourBar bar{.map = &colour_map("lagoon"), .from = -0.3, .to = 2.7, .title = "height in m"};
  DrawingArea room = colour_bar_room(bar);
  room.corner = {100, 50};
  draw_colour_bar(canvas, bar, room.corner);
  expect_tidy(canvas, room);
  const std::vector<shape::Rectangle> colours = shapes_of<shape::Rectangle>(canvas);
  const shape::Rectangle& frame = colours.back();
  for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
    if (words.text != "2.0") continue;
    EXPECT_NEAR(words.at.x(), frame.corner.x() + (2.0 + 0.3) / 3.0 * frame.width, 1e-6);
  }
  // Each covers the rest of the one before: the first is seen at the left.
  const shape::Rectangle& last = colours[colours.size() - 2];
  EXPECT_EQ(colours.front().fill->colour, colour_map("lagoon").at(0.5 / 128.0));
  EXPECT_EQ(last.fill->colour, colour_map("lagoon").at(127.5 / 128.0));
  EXPECT_TRUE(last.corner.isApprox(frame.corner + Point2(frame.width - last.width, 0.0)));
}

TEST(ScaleBar, IsAsLongAsItSays) {
  Canvas canvas(600, 100, "");
  draw_scale_bar(canvas, {.pixels_per_m = 37.0, .most = 160.0, .has_halo = false}, {20, 50});
  const shape::Line bar = shapes_of<shape::Line>(canvas).front();
  EXPECT_NEAR(bar.points[1].x() - bar.points[0].x(), 2.0 * 37.0, 1e-9);  // 5 m would be 185 pixels
  EXPECT_EQ(shapes_of<shape::Words>(canvas).front().text, "2 m");
  Canvas empty(600, 100, "");
  draw_scale_bar(empty, {.pixels_per_m = 0.0}, {20, 50});
  EXPECT_TRUE(empty.shapes().empty());
}

ErrorPlot errors_of_runs(std::size_t runs, const std::string& name) {
  ErrorPlot plot{"runs", "Position error", "m", {}};
  for (std::size_t k = 0; k < runs; ++k) {
    ErrorGroup group{name + std::to_string(k), {}};
    for (int i = 0; i < 2884; ++i) group.values.push_back(0.0457 + 1e-5 * (i % 100));
    plot.groups.push_back(group);
  }
  return plot;
}

TEST(ErrorPlots, BoxesOfManyRunsHaveWordsOfTheirOwn) {
  for (const std::size_t runs : {1U, 3U, 5U, 11U}) {
    const ErrorPlot plot = errors_of_runs(runs, "a_run_folder_with_a_rather_long_name_as_people_have-");
    const Canvas canvas = box_plot(plot, {960, 600});
    expect_tidy(canvas, DrawingArea{{0.0, 0.0}, 960.0, 600.0});
    std::set<std::string> names;
    std::size_t medians = 0;
    for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
      if (words.text.find("a_run") == 0) names.insert(words.text);
      if (words.text.find("0.0462") == 0) ++medians;
    }
    EXPECT_EQ(names.size(), runs);
    EXPECT_EQ(medians, runs);
  }
}

TEST(ErrorPlots, ErrorsThatAreAllZeroHaveNoAxisBelowZero) {
  const Canvas canvas = time_plot("", "Position error", "m", {{"run", {{0.0, 0.0}, {10.0, 0.0}}}}, {960, 600});
  for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
    EXPECT_EQ(words.text.find("\xE2\x88\x92"), std::string::npos) << words.text;
  }
}

}  // namespace
}  // namespace gdtslam
