// Words of pictures on sheets of any size: within the sheet, none over another.
#include <gtest/gtest.h>

#include "gdtslam/drawing/map_picture.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

struct Box {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  std::string text;
};

/// From the base line up by the height of capitals; a tenth of the width less, which text_width may be off.
std::vector<Box> boxes_of(const Canvas& canvas) {
  std::vector<Box> boxes;
  for (const shape::Words& words : shapes_of<shape::Words>(canvas)) {
    const double width = 0.9 * text_width(words.text, words.lettering.size, words.lettering.is_bold);
    const double tall = 0.7 * words.lettering.size;
    const double share = words.lettering.anchor == Anchor::kStart ? 0.0
                         : words.lettering.anchor == Anchor::kEnd ? 1.0
                                                                  : 0.5;
    const Point2& at = words.at;
    if (words.is_upright) {
      boxes.push_back({at.x() - tall, at.y() - (1.0 - share) * width, at.x(), at.y() + share * width, words.text});
    } else {
      boxes.push_back({at.x() - share * width, at.y() - tall, at.x() + (1.0 - share) * width, at.y(), words.text});
    }
  }
  return boxes;
}

void expect_tidy(const Canvas& canvas, const std::string& what) {
  const std::vector<Box> boxes = boxes_of(canvas);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box& a = boxes[i];
    EXPECT_GE(a.left, 0.0) << what << ": " << a.text;
    EXPECT_GE(a.top, 0.0) << what << ": " << a.text;
    EXPECT_LE(a.right, canvas.width()) << what << ": " << a.text;
    EXPECT_LE(a.bottom, canvas.height()) << what << ": " << a.text;
    for (std::size_t k = 0; k < i; ++k) {
      const Box& b = boxes[k];
      const bool is_apart = a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
      EXPECT_TRUE(is_apart) << what << ": " << a.text << " over " << b.text;
    }
  }
}

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
