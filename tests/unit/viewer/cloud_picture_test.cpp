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
#include "support/picture_scene.hpp"

namespace gdtslam::test {
namespace {

using ::testing::Contains;

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
        expect_tidy(canvas, std::to_string(size.width) + "x" + std::to_string(size.height));
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
    EXPECT_TRUE(has_words(canvas, "5 m"));
    // Two points 5 m apart at the target, across the line of sight, are as far apart in the picture as the bar is long.
    const Point3 across = (camera.target - camera.eye).cross(camera.up).normalized();
    const double expected =
        project(camera, size, camera.target + 5.0 * across)->x() - project(camera, size, camera.target)->x();
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
