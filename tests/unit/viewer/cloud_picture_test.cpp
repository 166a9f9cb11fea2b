// Words and bars over a cloud's picture: nothing overlaps or leaves the picture at any size, and what the bars say is
// so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam::test {
namespace {

using ::testing::Contains;
using ::testing::Not;

const ColourScale kScale{.quantity = "Height", .unit = "m", .least = -0.02, .most = 2.61, .colour_map = "lagoon"};
const CloudCaption kCaption{.title = "office-7f", .subtitle = "2,612,034 points, 63 m of path"};

std::shared_ptr<RgbaImage> page(const PictureSize& size, Colour colour) {
  auto image = std::make_shared<RgbaImage>(size.width, size.height);
  for (std::size_t k = 0; k < image->pixels.size(); k += 4) {
    image->pixels[k] = colour.red;
    image->pixels[k + 1] = colour.green;
    image->pixels[k + 2] = colour.blue;
    image->pixels[k + 3] = 255;
  }
  return image;
}

struct Box {
  double left, top, right, bottom;
  std::string what;
};

// The room of each line of words, a fifth of the size for what hangs below the base line.
std::vector<Box> words_of(const Canvas& canvas) {
  std::vector<Box> boxes;
  for (const Shape& shape : canvas.shapes()) {
    const auto* words = std::get_if<shape::Words>(&shape);
    if (words == nullptr) continue;
    const double size = words->lettering.size;
    const double width = text_width(words->text, size, words->lettering.is_bold);
    const double before = words->lettering.anchor == Anchor::kStart    ? 0.0
                          : words->lettering.anchor == Anchor::kMiddle ? 0.5 * width
                                                                       : width;
    const double left = words->at.x() - before;
    boxes.push_back({left, words->at.y() - 0.75 * size, left + width, words->at.y() + 0.2 * size, words->text});
  }
  return boxes;
}

std::vector<std::string> texts_of(const Canvas& canvas) {
  std::vector<std::string> texts;
  for (const Box& box : words_of(canvas)) texts.push_back(box.what);
  return texts;
}

Canvas picture(const PictureSize& size, const CloudLook& look, const CloudCaption& caption, bool is_parallel = false) {
  Camera camera = fitting_camera(is_parallel ? CameraPreset::kTop : CameraPreset::kIso,
                                 {{-2.0, -8.0, 0.0}, {34.0, 8.0, 2.6}}, size);
  return cloud_picture(page(size, look.is_dark ? kDarkTheme.page : kLightTheme.page), kScale, camera, look, caption);
}

TEST(CloudPicture, NothingOverlapsOrLeavesThePictureAtAnySize) {
  CloudCaption wordy = kCaption;
  wordy.title = "A cloud with a name that is much too long for most pictures, to say nothing of small ones";
  wordy.subtitle = wordy.title + " as its subtitle";
  for (const PictureSize& size : {PictureSize{480, 270},
                                  {640, 360},
                                  {1280, 720},
                                  {1920, 1080},
                                  {7680, 4320},
                                  {300, 900},
                                  {1000, 120},
                                  {64, 64},
                                  {8, 5}}) {
    for (const CloudCaption& caption : {kCaption, wordy}) {
      for (const bool is_dark : {false, true}) {
        const Canvas canvas = picture(size, {.colour_map = {}, .least = {}, .most = {}, .is_dark = is_dark}, caption);
        const std::vector<Box> boxes = words_of(canvas);
        for (std::size_t a = 0; a < boxes.size(); ++a) {
          const Box& box = boxes[a];
          EXPECT_GE(box.left, 0.0) << box.what << " " << size.width;
          EXPECT_GE(box.top, 0.0) << box.what << " " << size.width;
          EXPECT_LE(box.right, size.width) << box.what << " " << size.width;
          EXPECT_LE(box.bottom, size.height) << box.what << " " << size.width;
          for (std::size_t b = 0; b < a; ++b) {
            const Box& other = boxes[b];
            const bool is_apart = box.right <= other.left || other.right <= box.left || box.bottom <= other.top ||
                                  other.bottom <= box.top;
            EXPECT_TRUE(is_apart) << box.what << " over " << other.what << " at " << size.width << "x" << size.height;
          }
        }
      }
    }
  }
}

TEST(CloudPicture, ScaleBarIsAsLongAsItsLengthAtTheTarget) {
  const PictureSize size{1280, 720};
  for (const bool is_parallel : {false, true}) {
    Camera camera = fitting_camera(is_parallel ? CameraPreset::kTop : CameraPreset::kIso,
                                   {{-2.0, -8.0, 0.0}, {34.0, 8.0, 2.6}}, size);
    const Canvas canvas =
        cloud_picture(page(size, ink::kNight), kScale, camera, {.colour_map = {}, .least = {}, .most = {}}, kCaption);
    EXPECT_THAT(texts_of(canvas), Contains("5 m"));
    // Two points 5 m apart at the target, across the line of sight, are as far apart in the picture as the bar is long.
    const Point3 across = (camera.target - camera.eye).cross(camera.up).normalized();
    const double expected =
        project(camera, size, camera.target + 5.0 * across)->x_px - project(camera, size, camera.target)->x_px;
    std::vector<double> level_lengths;
    for (const Shape& shape : canvas.shapes()) {
      const auto* line = std::get_if<shape::Line>(&shape);
      if (line == nullptr || line->points.size() != 2 || line->points[0].y() != line->points[1].y()) continue;
      level_lengths.push_back(line->points[1].x() - line->points[0].x());
    }
    EXPECT_THAT(level_lengths, Contains(::testing::DoubleNear(expected, 1e-6)));
  }
}

}  // namespace
}  // namespace gdtslam::test
