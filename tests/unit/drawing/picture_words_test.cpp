// Words of pictures on sheets of any size: within the sheet, none over another.
#include <gtest/gtest.h>

#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

class Words : public ::testing::TestWithParam<PictureSize> {};

TEST_P(Words, of_maps_and_fields_are_tidy) {
  const PictureSize size = GetParam();
  const std::string name = std::to_string(size.width) + " x " + std::to_string(size.height);
  MapLook look;
  look.title = "A name that goes on and on, as names of files do: 2026-11-20-third-floor-second-attempt.clf.gz";
  look.subtitle = "13,631 scans, 515 m of path, 22 doubtful scans, 1,677 x 1,437 cells of 0.025 m, ½ of them über";
  const OccupancyMap map = two_rooms();
  const FieldPicture field = brute_field(map.geometry, obstacles_of(map), 5120);
  PathOverlay overlay = round_trip();
  expect_tidy(map_picture(map, overlay, look, size), "map " + name);
  expect_tidy(field_picture(field, overlay, look, size), "intensity " + name);
  look.is_intensity = false;
  expect_tidy(field_picture(field, overlay, look, size), "distance " + name);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Words,
                         ::testing::Values(PictureSize{480, 270}, PictureSize{270, 480}, PictureSize{640, 480},
                                           PictureSize{1600, 1200}, PictureSize{1080, 1920}, PictureSize{3000, 400},
                                           PictureSize{400, 3000}, PictureSize{8000, 8000}));

TEST(Words, too_small_a_sheet_has_none) {
  EXPECT_TRUE(shapes_of<shape::Words>(map_picture(two_rooms(), {}, {}, {199, 1000})).empty());
}

}  // namespace
}  // namespace gdtslam
