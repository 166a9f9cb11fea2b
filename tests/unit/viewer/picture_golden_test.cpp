// Pictures of a map and its field against goldens without words, and faults that must not pass for them.
#include <gtest/gtest.h>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "support/image_compare.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

/// Too small for words, so that no font matters.
constexpr PictureSize kMapSize{288, 196};
/// Cairo's edges differ a little between its versions; the faults below are more.
constexpr ImageTolerance kMapTolerance{.mean = 0.1, .share_clear = 0.0006, .clear_step = 24};

FieldPicture field() {
  const OccupancyMap map = two_rooms();
  return brute_field(map.geometry, obstacles_of(map), 2560);
}

RgbaImage map_image(const OccupancyMap& map, const PathOverlay& overlay) {
  return rasterise(map_picture(map, overlay, {}, kMapSize));
}

RgbaImage field_image(const PathOverlay& overlay, bool is_intensity, const std::string& colour_map = "") {
  MapLook look;
  look.is_intensity = is_intensity;
  look.colour_map = colour_map;
  return rasterise(field_picture(field(), overlay, look, kMapSize));
}

TEST(PictureGolden, map) {
  EXPECT_TRUE(matches_golden(map_image(two_rooms(), round_trip()), "map_occupancy", kMapTolerance));
}

TEST(PictureGolden, field_as_intensity) {
  EXPECT_TRUE(matches_golden(field_image(round_trip(), true), "map_intensity", kMapTolerance));
}

TEST(PictureGolden, field_as_distance) {
  EXPECT_TRUE(matches_golden(field_image(round_trip(), false), "map_distance", kMapTolerance));
}

TEST(PictureGolden, faults_of_the_map_do_not_pass) {
  const RgbaImage expected = golden("map_occupancy");
  const auto passes = [&](const OccupancyMap& map, const PathOverlay& overlay) {
    return is_alike(map_image(map, overlay), expected, kMapTolerance);
  };
  EXPECT_FALSE(passes(two_rooms(), round_trip(0.1))) << "path shifted by one cell";
  PathOverlay overlay = round_trip();
  overlay.doubtful = {35};
  EXPECT_FALSE(passes(two_rooms(), overlay)) << "a doubtful scan is missing";
  overlay = round_trip();
  std::reverse(overlay.trajectory.begin(), overlay.trajectory.end());
  EXPECT_FALSE(passes(two_rooms(), overlay)) << "time runs backwards";
  OccupancyMap map = two_rooms();
  OccupancyMap mirrored = map;
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      set(mirrored, x, map.geometry.height - 1 - y, map.at({x, y}));
    }
  }
  EXPECT_FALSE(passes(mirrored, round_trip())) << "upside down";
  for (std::int32_t i = 0; i < 4; ++i) set(map, 12 + i, 30, CellState::kFree);
  EXPECT_FALSE(passes(map, round_trip())) << "four cells are missing";
}

TEST(PictureGolden, faults_of_the_field_do_not_pass) {
  const RgbaImage intensity = golden("map_intensity");
  EXPECT_FALSE(is_alike(field_image(round_trip(), true, "ember"), intensity, kMapTolerance)) << "wrong colours";
  EXPECT_FALSE(is_alike(field_image(round_trip(0.1), true), intensity, kMapTolerance)) << "path shifted by one cell";
  EXPECT_FALSE(is_alike(field_image({}, true), intensity, kMapTolerance)) << "no path";
  const RgbaImage distance = golden("map_distance");
  EXPECT_FALSE(is_alike(field_image(round_trip(), false, "ember"), distance, kMapTolerance)) << "wrong colours";
  EXPECT_FALSE(is_alike(field_image(round_trip(0.1), false), distance, kMapTolerance)) << "path shifted by one cell";
}

}  // namespace
}  // namespace gdtslam
