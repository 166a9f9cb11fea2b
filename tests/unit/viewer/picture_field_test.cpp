// The picture of a distance field: bright near obstacles or metres, unknown told apart, no obstacle lost.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/drawing/maps/path_layer.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

constexpr PictureSize kBare{190, 150};
constexpr std::uint16_t kCap = 5120;  // 20 cells

/// One row of obstacles at the left: the distance of a cell is its column.
FieldPicture ramp(std::int32_t width = 24) {
  std::vector<CellIndex> wall;
  for (std::int32_t y = 0; y < 12; ++y) wall.push_back({0, y});
  return brute_field({0.1, 0.0, 0.0, width, 12}, wall, kCap);
}

/// Colours along the middle row of the picture, one for each step of colour; a single pixel between two is where the
/// field's edge cuts it.
std::vector<Colour> colours_along(const RgbaImage& image) {
  std::vector<Colour> colours;
  const auto at = [&](std::uint32_t x) {
    const std::uint8_t* const pixel = image.at(x, image.height / 2);
    return Colour{pixel[0], pixel[1], pixel[2]};
  };
  for (std::uint32_t x = 1; x < image.width; ++x) {
    if (at(x) == at(x - 1) && (colours.empty() || !(colours.back() == at(x)))) colours.push_back(at(x));
  }
  return colours;
}

double brightness_of(Colour colour) { return 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue; }

TEST(FieldPicture, intensity_falls_from_obstacles_and_ends_before_the_unknown) {
  const std::vector<Colour> colours = colours_along(rasterise(field_picture(ramp(), {}, {}, kBare)));
  // Unknown beside the field, 20 cells with a distance of 0 to 19, unknown again.
  ASSERT_EQ(colours.size(), 22U);
  EXPECT_EQ(colours.front(), colours.back());
  EXPECT_GT(brightness_of(colours[1]), 230.0) << "obstacles shine";
  for (std::size_t i = 2; i < 21; ++i) EXPECT_LT(brightness_of(colours[i]), brightness_of(colours[i - 1])) << i;
  EXPECT_GT(brightness_of(colours[20]), brightness_of(colours[21]) + 15.0) << "seen, though far";
}

TEST(FieldPicture, an_obstacle_survives_ten_to_one) {
  // All at 10 cells but one obstacle between walls far apart: no distance transform, so that nothing helps it.
  FieldPicture field{{0.02, 0.0, 0.0, 1500, 1200}, {}, kCap};
  field.cells.assign(field.geometry.cell_count(), 2560);
  const auto set_at = [&](std::size_t x, std::size_t y) { field.cells[y * 1500 + x] = 0; };
  for (std::size_t x = 0; x < 1500; ++x) {
    set_at(x, 0);
    set_at(x, 1199);
  }
  for (std::size_t y = 0; y < 1200; ++y) {
    set_at(0, y);
    set_at(1499, y);
  }
  const RgbaImage without = rasterise(field_picture(field, {}, {}, kBare));
  set_at(700, 503);
  const RgbaImage with = rasterise(field_picture(field, {}, {}, kBare));
  int pixels = 0;
  for (std::uint32_t y = 0; y < with.height; ++y) {
    for (std::uint32_t x = 0; x < with.width; ++x) {
      const double brighter = brightness(with.at(x, y)) - brightness(without.at(x, y));
      if (brighter < 1.0) continue;
      ++pixels;
      EXPECT_GT(brightness(with.at(x, y)), 230.0) << "as bright as any obstacle";
    }
  }
  EXPECT_EQ(pixels, 1);
}

TEST(FieldPicture, what_cannot_be_drawn_is_refused) {
  FieldPicture field = ramp();
  field.cells.pop_back();
  EXPECT_THROW(field_picture(field, {}, {}, kBare), InputError);
  field = ramp();
  field.cap = 0;
  EXPECT_THROW(field_picture(field, {}, {}, kBare), InputError);
  EXPECT_THROW(field_picture(FieldPicture{}, {}, {}, kBare), InputError);
}

}  // namespace
}  // namespace gdtslam
