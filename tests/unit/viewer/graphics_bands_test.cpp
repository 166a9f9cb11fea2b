// Pictures that are drawn band by band: nothing is lost or drawn twice where bands meet. Expected: the rows of a
// picture, counted; the discs of the whole picture.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "gdtslam/core/random.hpp"
#include "viewer/graphics/picture_view.hpp"
#include "viewer/scene/cloud/cloud_points.hpp"

namespace gdtslam {
namespace {

TEST(Bands, KeepEveryRowOnce) {
  for (const std::uint32_t width : {1U, 640U, 3200U, 16384U}) {
    for (const std::uint32_t samples : {1U, 2U, 3U, 4U}) {
      for (const std::uint32_t margin : {0U, 8U, 96U}) {
        const std::uint32_t height = 600 * samples;
        std::uint32_t next = 0;
        const std::vector<PictureBand> bands = cut_into_bands(width, height, {samples, margin});
        for (const PictureBand& band : bands) {
          ASSERT_EQ(band.first_kept, next) << width << " " << samples << " " << margin;
          ASSERT_EQ(band.kept % samples, 0U);
          ASSERT_GT(band.kept, 0U);
          ASSERT_EQ(band.rows, bands.front().rows);
          ASSERT_LE(band.first_row + band.rows, height);
          const std::uint32_t above = height - (band.first_kept + band.kept);
          ASSERT_LE(band.first_row + std::min(margin, band.first_kept), band.first_kept);
          ASSERT_GE(band.first_row + band.rows, band.first_kept + band.kept + std::min(margin, above));
          next += band.kept;
        }
        ASSERT_EQ(next, height);
      }
    }
  }
}

/// A view of 200 x 160 pixels in the bands that are given.
PictureView small_view(std::vector<PictureBand> bands) {
  Camera camera{.eye = {0.0, -10.0, 0.0}};
  return {.camera = camera,
          .range = {.nearest_m = 1.0, .farthest_m = 30.0},
          .width = 200,
          .height = 160,
          .bands = std::move(bands)};
}

RawPicture blank(std::uint32_t width, std::uint32_t rows) {
  RawPicture picture{.width = width, .height = rows, .rgba = {}, .depth = {}};
  picture.rgba.resize(std::size_t{4} * width * rows, 0);
  picture.depth.resize(std::size_t{width} * rows, 1.0F);
  return picture;
}

TEST(Dots, BandsTogetherAreThePictureInOne) {
  Random random(7);
  std::vector<Dot> dots;
  for (int k = 0; k < 3000; ++k) {
    const auto coordinate = [&random](double half) { return static_cast<float>(random.uniform(-half, half)); };
    const auto shade = static_cast<std::uint8_t>(random.below(256));
    dots.push_back({.place = {coordinate(4.0), coordinate(8.0), coordinate(3.0)},
                    .colour = {shade, static_cast<std::uint8_t>(255 - shade), 90},
                    .size_code = diameter_code(random.uniform(0.01, 0.4))});
  }
  const auto painted = [&dots](const PictureView& view, const PictureBand& band) {
    RawPicture picture = blank(view.width, band.rows);
    const DotPainter painter(view, Point3::Zero(), {1.5, 40.0}, {});
    for (const Dot& dot : dots) {
      const auto [begin, end] = painter.touched_rows(dot);
      if (begin < band.first_row + band.rows && end > band.first_row) painter.paint(dot, band, picture);
    }
    return picture;
  };
  const PictureBand whole{0, 160, 0, 160};
  const RawPicture expected = painted(small_view({whole}), whole);
  for (const std::uint32_t first : {0U, 37U, 100U}) {
    const PictureBand band{first, 60, first, 60};
    const RawPicture part = painted(small_view({band}), band);
    const std::size_t skipped = std::size_t{first} * 200;
    for (std::size_t i = 0; i < part.depth.size(); ++i) {
      ASSERT_EQ(part.depth[i], expected.depth[skipped + i]) << first << " " << i;
      for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(part.rgba[4 * i + c], expected.rgba[4 * (skipped + i) + c]);
    }
  }
}

}  // namespace
}  // namespace gdtslam
