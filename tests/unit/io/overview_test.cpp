// The overview: what must be where in the picture, by its colours.
#include "engine/io/maps/overview.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"
#include "nlohmann/json.hpp"

namespace gdtslam {
namespace {

using Rgb = std::array<int, 3>;
constexpr Rgb kWhite = {255, 255, 255};

Rgb pixel(const RgbImage& image, double x, double y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x));
  return {image.pixels.at(i), image.pixels.at(i + 1), image.pixels.at(i + 2)};
}
int brightness(const Rgb& rgb) { return rgb[0] + rgb[1] + rgb[2]; }
/// Grey levels differ little between the channels, the trajectory's colours much.
int colourfulness(const Rgb& rgb) {
  return *std::max_element(rgb.begin(), rgb.end()) - *std::min_element(rgb.begin(), rgb.end());
}

void set(OccupancyMap& map, std::int32_t x, std::int32_t y, CellState state) {
  map.cells.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(map.geometry.width) +
               static_cast<std::size_t>(x)) = state;
}

/// A room of 8 x 4 m, walls one cell thick, within unknown land, its lower left corner at (1, 2).
OccupancyMap room() {
  OccupancyMap map;
  map.geometry = {0.1, 0.0, 0.0, 120, 80};
  map.cells.assign(map.geometry.cell_count(), CellState::kUnknown);
  for (std::int32_t y = 20; y < 60; ++y) {
    for (std::int32_t x = 10; x < 90; ++x) {
      const bool is_wall = x == 10 || x == 89 || y == 20 || y == 59;
      set(map, x, y, is_wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

struct Place {
  double x;
  double y;
};
Place place(const OverviewFrame& frame, double x_m, double y_m) {
  return {frame.left_px + (x_m - frame.x_m) / frame.m_per_pixel, frame.top_px + (frame.y_m - y_m) / frame.m_per_pixel};
}

TEST(Overview, ShowsWallsFreeAndUnknownWhereTheyAre) {
  const OccupancyMap map = room();
  const Trajectory trajectory;
  const OverviewInput input{.map = map, .trajectory = trajectory};
  const OverviewFrame frame = overview_frame(input);
  const RgbImage image = draw_overview(input);
  const auto at = [&](double x_m, double y_m) {
    const Place p = place(frame, x_m, y_m);
    return pixel(image, p.x, p.y);
  };
  EXPECT_EQ(at(5.0, 4.0), kWhite);
  EXPECT_LT(brightness(at(1.05, 4.0)), 150);   // left wall
  EXPECT_LT(brightness(at(5.0, 5.95)), 150);   // upper wall
  EXPECT_LT(brightness(at(8.95, 2.05)), 150);  // lower right corner
  EXPECT_GT(brightness(at(0.8, 4.0)), 500);    // unknown: light grey, no white
  EXPECT_LT(brightness(at(0.8, 4.0)), 750);
}

TEST(Overview, UpIsUp) {
  OccupancyMap map = room();
  set(map, 50, 50, CellState::kOccupied);  // in the upper half of the room
  const Trajectory trajectory;
  const OverviewInput input{.map = map, .trajectory = trajectory};
  const OverviewFrame frame = overview_frame(input);
  const Place p = place(frame, 5.05, 5.05);
  EXPECT_LT(brightness(pixel(draw_overview(input), p.x, p.y)), 150);
  EXPECT_LT(p.y, frame.top_px + frame.height_px / 2.0);
}

TEST(Overview, IsCroppedToTheBuildingAndSizedToTheUsualSide) {
  const OccupancyMap map = room();
  const Trajectory trajectory;
  const OverviewFrame frame = overview_frame({.map = map, .trajectory = trajectory});
  EXPECT_EQ(std::max(frame.width_px, frame.height_px), kOverviewSide);
  EXPECT_NEAR(frame.width_px * frame.m_per_pixel, 8.0 + 2 * 0.5, 0.02);  // the room and half a metre around
  EXPECT_NEAR(frame.height_px * frame.m_per_pixel, 4.0 + 2 * 0.5, 0.02);
  EXPECT_NEAR(frame.x_m, 0.5, 0.01);
  EXPECT_NEAR(frame.y_m, 6.5, 0.01);
}

TEST(Overview, BeamsThroughWindowsDoNotShrinkTheBuilding) {
  OccupancyMap map = room();
  // A fan of free cells from the right wall to the edge of the grid, an eighth of all that is known, and one return.
  for (std::int32_t x = 90; x < 120; ++x) {
    for (std::int32_t y = 33; y < 47; ++y) set(map, x, y, CellState::kFree);
  }
  set(map, 119, 40, CellState::kOccupied);
  // To be shown all the same: the robot itself has been beyond the upper wall, at y = 7.
  const Trajectory trajectory = {{0, {5, 4, 0}}, {1, {5, 7, 0}}};
  const OverviewFrame frame = overview_frame({.map = map, .trajectory = trajectory});
  EXPECT_NEAR(frame.width_px * frame.m_per_pixel, 8.0 + 2 * 0.5, 0.02);
  EXPECT_NEAR(frame.height_px * frame.m_per_pixel, 5.0 + 2 * 0.5, 0.02);
  EXPECT_NEAR(frame.y_m, 7.5, 0.01);
}

TEST(Overview, WithoutWallsTheKnownCellsAreShown) {
  OccupancyMap map = room();
  for (CellState& cell : map.cells) cell = cell == CellState::kOccupied ? CellState::kFree : cell;
  const Trajectory trajectory;
  const OverviewFrame frame = overview_frame({.map = map, .trajectory = trajectory});
  EXPECT_NEAR(frame.width_px * frame.m_per_pixel, 8.0 + 2 * 0.5, 0.02);
  EXPECT_NEAR(frame.height_px * frame.m_per_pixel, 4.0 + 2 * 0.5, 0.02);
}

TEST(Overview, PathIsAThinLine) {
  const OccupancyMap map = room();
  const Trajectory trajectory = {{0, {2, 4, 0}}, {1, {8, 4, 0}}};
  const OverviewInput input{.map = map, .trajectory = trajectory};
  const OverviewFrame frame = overview_frame(input);
  const RgbImage image = draw_overview(input);
  const Place p = place(frame, 5.0, 4.0);
  // The colour's share across the line, summed over its pixels, is its width whatever the anti-aliasing.
  int fullest = 0;
  int sum = 0;
  for (double y = p.y - 8; y <= p.y + 8; ++y) {
    const int colour = colourfulness(pixel(image, p.x, y));
    fullest = std::max(fullest, colour);
    sum += colour;
  }
  EXPECT_NEAR(static_cast<double>(sum) / fullest, 2.5, 0.5);
}

/// Dark pixels and red ones below the map.
struct LegendInk {
  int dark = 0;
  int red = 0;
  bool operator==(const LegendInk&) const = default;
};
LegendInk legend_ink(const OverviewInput& input) {
  const OverviewFrame frame = overview_frame(input);
  const RgbImage image = draw_overview(input);
  LegendInk ink;
  for (double y = frame.top_px + frame.height_px + 2; y < image.height; ++y) {
    for (double x = 0; x < image.width; ++x) {
      const Rgb rgb = pixel(image, x, y);
      ink.dark += brightness(rgb) < 300 ? 1 : 0;
      ink.red += rgb[0] > 190 && rgb[1] < 60 && rgb[2] < 90 ? 1 : 0;
    }
  }
  return ink;
}

TEST(Overview, LegendNamesTheMarksThatArePresent) {
  const OccupancyMap map = room();
  const Trajectory trajectory = {{0, {2, 3, 0}}, {1, {5, 5, 0}}, {2, {8, 3, 0}}};
  const LegendInk plain = legend_ink({.map = map, .trajectory = trajectory});
  const LegendInk keyframes = legend_ink({.map = map, .trajectory = trajectory, .keyframes = {0, 1}});
  const LegendInk doubtful = legend_ink({.map = map, .trajectory = trajectory, .doubtful = {1}});
  const LegendInk both = legend_ink({.map = map, .trajectory = trajectory, .doubtful = {1}, .keyframes = {0, 1}});
  EXPECT_GT(keyframes.dark, plain.dark + 200);
  EXPECT_EQ(keyframes.red, plain.red);
  EXPECT_GT(doubtful.dark, plain.dark + 200);
  EXPECT_GT(doubtful.red, plain.red + 20);
  EXPECT_GT(both.dark, std::max(keyframes.dark, doubtful.dark) + 200);
}

TEST(Overview, TheLongestLegendFitsANarrowPicture) {
  OccupancyMap map;
  map.geometry = {0.1, 0.0, 0.0, 20, 400};
  map.cells.assign(map.geometry.cell_count(), CellState::kOccupied);
  const Trajectory trajectory = {{0, {1, 1, 0}}, {1, {1, 39, 0}}};
  const std::vector<std::size_t> many(88888, 1);
  const OverviewInput input{.map = map, .trajectory = trajectory, .doubtful = many, .keyframes = many};
  const RgbImage image = draw_overview(input);
  for (double y = image.height - 50; y < image.height; ++y) {
    for (double x = image.width - 12; x < image.width; ++x) EXPECT_EQ(pixel(image, x, y), kWhite);
  }
}

TEST(Overview, TrajectoryIsColouredAndChangesColourOnItsWay) {
  const OccupancyMap map = room();
  Trajectory trajectory;
  for (int i = 0; i <= 100; ++i) {
    trajectory.push_back({0.1 * i, {2.0 + 0.06 * i, 4.0, 0.0}});
  }
  const OverviewInput input{.map = map, .trajectory = trajectory};
  const OverviewFrame frame = overview_frame(input);
  const RgbImage image = draw_overview(input);
  const auto at = [&](double x_m, double y_m) {
    const Place p = place(frame, x_m, y_m);
    return pixel(image, p.x, p.y);
  };
  EXPECT_GT(colourfulness(at(3.0, 4.0)), 60);
  EXPECT_GT(colourfulness(at(7.0, 4.0)), 60);
  EXPECT_GT(at(3.0, 4.0)[2], at(3.0, 4.0)[0]);  // bluer at the start
  EXPECT_LT(at(7.0, 4.0)[2], at(7.0, 4.0)[0]);  // redder at the end
  EXPECT_EQ(at(5.0, 3.8), kWhite);
  EXPECT_GT(colourfulness(at(2.0, 4.0)), 60);  // the start is a full disc,
  EXPECT_EQ(at(8.0, 4.0), kWhite);             // the end a hollow one
}

TEST(Overview, DoubtfulScansAreMarkedInRed) {
  const OccupancyMap map = room();
  const Trajectory trajectory = {{0, {2, 3, 0}}, {1, {5, 5, 0}}, {2, {8, 3, 0}}};
  const auto reds = [&](std::vector<std::size_t> doubtful) {
    const OverviewInput input{.map = map, .trajectory = trajectory, .doubtful = std::move(doubtful)};
    const OverviewFrame frame = overview_frame(input);
    const RgbImage image = draw_overview(input);
    const Place p = place(frame, 5.0, 5.0);
    int count = 0;
    for (double y = p.y - 6; y <= p.y + 6; ++y) {
      for (double x = p.x - 6; x <= p.x + 6; ++x) {
        const Rgb rgb = pixel(image, x, y);
        count += rgb[0] > 190 && rgb[1] < 60 && rgb[2] < 90 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(reds({}), 0);
  EXPECT_GT(reds({1}), 20);
}

TEST(Overview, TitleAndScaleBarAreDrawn) {
  const OccupancyMap map = room();
  const Trajectory trajectory;
  const auto ink = [&](const std::string& title, bool in_header) {
    const OverviewInput input{.map = map, .trajectory = trajectory, .title = title};
    const OverviewFrame frame = overview_frame(input);
    const RgbImage image = draw_overview(input);
    const double begin = in_header ? 0.0 : frame.top_px + frame.height_px + 2;
    const double end = in_header ? frame.top_px - 2 : image.height;
    int count = 0;
    for (double y = begin; y < end; ++y) {
      for (double x = 0; x < image.width; ++x) {
        count += brightness(pixel(image, x, y)) < 300 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(ink("", true), 0);
  EXPECT_GT(ink("Office", true), 200);
  EXPECT_GT(ink("Long title with \xc3\xa9", true), ink("Office", true));
  EXPECT_GT(ink("", false), 400);
}

TEST(Overview, ScaleBarHasItsStatedLength) {
  const OccupancyMap map = room();  // 9 m in 1600 pixels: the longest of 1, 2, 5 below 220 pixels (1.24 m) is 1 m
  const Trajectory trajectory;
  const OverviewInput input{.map = map, .trajectory = trajectory};
  const RgbImage image = draw_overview(input);
  const double y = image.height - 31.0;
  int longest = 0;
  int run = 0;
  for (double x = 0; x < image.width; ++x) {
    run = brightness(pixel(image, x, y)) < 300 ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  EXPECT_NEAR(longest, 1600.0 / 9.0, 1.5);
}

TEST(Overview, NothingAndNonsenseAreDrawnWithoutHarm) {
  OccupancyMap map;
  map.geometry = {0.05, 0.0, 0.0, 1, 1};
  map.cells = {CellState::kUnknown};
  const Trajectory none;
  EXPECT_GT(draw_overview({.map = map, .trajectory = none}).pixels.size(), 0U);
  const OccupancyMap building = room();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Trajectory wild = {{0, {5, 4, 0}}, {1, {kNan, 4, 0}}, {2, {1e300, -1e300, 0}}, {3, {5, 4.5, 0}}};
  const OverviewInput input{.map = building, .trajectory = wild, .doubtful = {1, 2}, .keyframes = {1, 2}};
  EXPECT_NEAR(overview_frame(input).m_per_pixel * kOverviewSide, 9.0, 0.1);
  EXPECT_GT(draw_overview(input).pixels.size(), 0U);
}

TEST(Overview, SameInputSameBytes) {
  const OccupancyMap map = room();
  const Trajectory trajectory = {{0, {2, 3, 0}}, {1, {5, 5, 0}}};
  const TemporaryFolder folder;
  write_overview(folder / "a.png", {.map = map, .trajectory = trajectory, .title = "a"});
  write_overview(folder / "b.png", {.map = map, .trajectory = trajectory, .title = "a"});
  EXPECT_EQ(get_file(folder / "a.png"), get_file(folder / "b.png"));
}

TEST(JsonFile, NumbersReadBackAndTextIsMadeUtf8) {
  const nlohmann::ordered_json value = {{"z", 0.1},
                                        {"a", std::nan("")},
                                        {"path",
                                         "bad\xff"
                                         "byte"}};
  const std::string text = json_text(value);
  EXPECT_EQ(text,
            "{\n  \"z\": 0.1,\n  \"a\": null,\n  \"path\": \"bad\xef\xbf\xbd"
            "byte\"\n}\n");
  const TemporaryFolder folder;
  write_json(folder / "r.json", value);
  EXPECT_EQ(get_file(folder / "r.json"), text);
}

}  // namespace
}  // namespace gdtslam
