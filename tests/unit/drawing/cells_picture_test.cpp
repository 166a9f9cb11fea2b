// Figure 3: the numbers against a distance transform by its definition, and whether they can be read.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "engine/core/elementary.hpp"
#include "engine/drawing/maps/cell_number.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

/// What a cell of the picture shows, by its column and row counted from the lower left of the part.
struct Shown {
  std::string text;
  Colour ground;
  Colour letters;
};
using Table = std::map<std::pair<int, int>, Shown>;

/// The squares of the picture with the words in each.
Table table_of(const Canvas& canvas, std::int32_t width, std::int32_t height) {
  std::vector<shape::Rectangle> squares;
  for (const shape::Rectangle& one : shapes_of<shape::Rectangle>(canvas)) {
    if (one.width == one.height && one.width > 30.0 && one.fill) squares.push_back(one);
  }
  EXPECT_EQ(squares.size(), static_cast<std::size_t>(width * height));
  double left = 1e9;
  double bottom = -1e9;
  for (const shape::Rectangle& one : squares) {
    left = std::min(left, one.corner.x());
    bottom = std::max(bottom, one.corner.y() + one.height);
  }
  Table table;
  for (const shape::Rectangle& one : squares) {
    const int x = static_cast<int>(std::lround((one.corner.x() - left) / one.width));
    const int y = static_cast<int>(std::lround((bottom - one.corner.y()) / one.height)) - 1;
    Shown& shown = table[{x, y}];
    shown.ground = one.fill->colour;
    for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
      if (words.at.x() < one.corner.x() || words.at.x() > one.corner.x() + one.width) continue;
      if (words.at.y() < one.corner.y() || words.at.y() > one.corner.y() + one.height) continue;
      shown.text += words.text;
      shown.letters = words.lettering.colour;
    }
  }
  return table;
}

constexpr std::int32_t kWidth = 17;
constexpr std::int32_t kHeight = 11;
const std::vector<CellIndex> kObstacles{{2, 3}, {3, 3}, {4, 4}, {12, 9}, {16, 0}, {0, 10}};

int squared_distance(int x, int y) {
  int least = 1 << 30;
  for (const CellIndex& obstacle : kObstacles) {
    least = std::min(least, (x - obstacle.x) * (x - obstacle.x) + (y - obstacle.y) * (y - obstacle.y));
  }
  return least;
}

FieldPicture sample() { return brute_field({0.05, 0.0, 0.0, kWidth, kHeight}, kObstacles, 5120); }

TEST(CellsPicture, squared_numbers_are_those_of_the_definition) {
  const Table table = table_of(cells_picture(sample(), {{0, 0}, {kWidth, kHeight}}, true, {}), kWidth, kHeight);
  for (const auto& [at, shown] : table) {
    EXPECT_EQ(shown.text, std::to_string(squared_distance(at.first, at.second))) << at.first << ", " << at.second;
  }
}

TEST(CellsPicture, distances_have_one_decimal_where_they_are_not_whole) {
  const Table table = table_of(cells_picture(sample(), {{0, 0}, {kWidth, kHeight}}, false, {}), kWidth, kHeight);
  for (const auto& [at, shown] : table) {
    const double exact = std::sqrt(squared_distance(at.first, at.second));
    const bool is_whole = exact == std::floor(exact);
    EXPECT_NE(shown.text.find('.'), std::string::npos) << shown.text << " beside numbers with a decimal";
    EXPECT_NEAR(std::atof(shown.text.c_str()), exact, is_whole ? 0.0 : 0.05 + 1.0 / 512.0);
  }
}

/// Contrast of WCAG 2 by its text: (L1 + 0.05) / (L2 + 0.05).
double contrast(Colour a, Colour b) {
  const auto luminance = [](Colour colour) {
    const auto light = [](double value) {
      return value <= 0.04045 ? value / 12.92 : gdtslam::exp(2.4 * gdtslam::log((value + 0.055) / 1.055));
    };
    return 0.2126 * light(colour.red / 255.0) + 0.7152 * light(colour.green / 255.0) +
           0.0722 * light(colour.blue / 255.0);
  };
  const double one = luminance(a) + 0.05;
  const double other = luminance(b) + 0.05;
  return std::max(one, other) / std::min(one, other);
}

TEST(CellsPicture, numbers_can_be_read_on_every_colour_of_every_map) {
  for (const ColourMap& map : colour_maps()) {
    MapLook look;
    look.colour_map = map.name();
    const Table table = table_of(cells_picture(sample(), {{0, 0}, {kWidth, kHeight}}, false, look), kWidth, kHeight);
    for (const auto& [at, shown] : table) EXPECT_GE(contrast(shown.letters, shown.ground), 4.5) << map.name();
    for (const Colour ground : map.table()) EXPECT_GE(contrast(picture::legible_on(ground), ground), 4.5);
  }
  EXPECT_NEAR(picture::contrast_of({0, 0, 0}, {255, 255, 255}), 21.0, 1e-9) << "the largest there is";
}

TEST(CellsPicture, unknown_cells_have_no_number) {
  FieldPicture field = sample();
  field.cap = 3 * 256;
  for (std::uint16_t& cell : field.cells) cell = std::min(cell, field.cap);
  const Canvas canvas = cells_picture(field, {{0, 0}, {kWidth, kHeight}}, true, {});
  for (const auto& [at, shown] : table_of(canvas, kWidth, kHeight)) {
    EXPECT_EQ(shown.text == "–", squared_distance(at.first, at.second) >= 9) << shown.text;
  }
  EXPECT_TRUE(says(canvas, "3 cells or more"));
}

TEST(CellsPicture, parts_that_cannot_be_read_are_refused) {
  const FieldPicture field = brute_field({0.05, 0.0, 0.0, 70, 70}, {{3, 3}}, 5120);
  EXPECT_THROW(cells_picture(field, {{0, 0}, {61, 10}}, true, {}), InputError);
  EXPECT_THROW(cells_picture(field, {{0, 0}, {10, 61}}, true, {}), InputError);
  EXPECT_NO_THROW(cells_picture(field, {{10, 10}, {70, 70}}, true, {}));
  EXPECT_THROW(cells_picture(field, {{60, 60}, {71, 70}}, true, {}), InputError);
  EXPECT_THROW(cells_picture(field, {{-1, 0}, {5, 5}}, true, {}), InputError);
  EXPECT_THROW(cells_picture(field, {{5, 5}, {5, 9}}, true, {}), InputError);
  EXPECT_THROW(cells_picture(field, {{2147483647, 0}, {-2147483647, 5}}, true, {}), InputError);
}

}  // namespace
}  // namespace gdtslam
