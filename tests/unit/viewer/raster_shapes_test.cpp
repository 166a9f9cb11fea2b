// Pixels of drawings whose shapes lie at known places.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {
namespace {

using Pixel = std::array<int, 4>;
constexpr Pixel kNothing{0, 0, 0, 0};
constexpr Pixel kRedPixel{255, 0, 0, 255};
constexpr Pixel kBlue{0, 0, 255, 255};
const Fill kRedFill{colour_for(0xff0000)};
const Fill kBlueFill{colour_for(0x0000ff)};

Pixel at(const RgbaImage& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* pixel = image.at(x, y);
  return {pixel[0], pixel[1], pixel[2], pixel[3]};
}

std::shared_ptr<RgbaImage> chequered(std::uint32_t width, std::uint32_t height) {
  auto image = std::make_shared<RgbaImage>(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      std::uint8_t* pixel = image->at(x, y);
      pixel[0] = static_cast<std::uint8_t>(37 * x + 11 * y);
      pixel[1] = static_cast<std::uint8_t>(5 * x * y);
      pixel[2] = static_cast<std::uint8_t>(200 - x);
      pixel[3] = 255;
    }
  }
  return image;
}

TEST(Raster, ColoursAreNotMultipliedByAlpha) {
  Canvas canvas(4, 4, "");
  canvas.rectangle({0, 0}, 4, 4, Fill{colour_for(0xff8040), 0.5});
  const Pixel pixel = at(rasterise(canvas), 1, 1);
  EXPECT_NEAR(pixel[0], 255, 1);
  EXPECT_NEAR(pixel[1], 128, 1);
  EXPECT_NEAR(pixel[2], 64, 1);
  EXPECT_NEAR(pixel[3], 128, 1);
}

TEST(Raster, APictureOfItsOwnSizeKeepsEveryPixel) {
  const auto picture = chequered(64, 48);
  for (const bool is_first : {true, false}) {  // the short way and the long one
    Canvas canvas(64, 48, "");
    if (!is_first) canvas.circle({1, 1}, 1, kRedFill);
    canvas.picture({0, 0}, 64, 48, picture);
    EXPECT_EQ(rasterise(canvas).pixels, picture->pixels) << is_first;
  }
}

TEST(Raster, AClipHidesWhatLeavesItAndEnds) {
  Canvas canvas(40, 40, "");
  canvas.polygon({{30, 30}, {39, 30}, {39, 39}}, kBlueFill);  // its path is no part of the clip
  canvas.begin_clip({10, 10}, 10, 10);
  canvas.rectangle({0, 0}, 40, 40, kRedFill);
  canvas.end_clip();
  canvas.end_clip();  // one too many
  canvas.rectangle({0, 0}, 5, 5, kBlueFill);
  const RgbaImage image = rasterise(canvas);
  EXPECT_EQ(at(image, 9, 15), kNothing);
  EXPECT_EQ(at(image, 10, 15), kRedPixel);
  EXPECT_EQ(at(image, 19, 19), kRedPixel);
  EXPECT_EQ(at(image, 20, 19), kNothing);
  EXPECT_EQ(at(image, 37, 32), kBlue);
  EXPECT_EQ(at(image, 2, 2), kBlue);
}

TEST(Raster, ASizeBeyondReasonIsRefused) {
  EXPECT_THROW((void)rasterise(Canvas(40000, 10, "")), Error);
  EXPECT_THROW((void)rasterise(Canvas(10, 10, ""), 4000.0), Error);
  EXPECT_THROW((void)rasterise(Canvas(0, 10, "")), Error);
}

TEST(Raster, TheSameDrawingGivesTheSameBytes) {
  Canvas canvas(120, 60, "Title");
  canvas.text({10, 30}, "crank 12.5\u00B0", {.size = 14});
  canvas.picture({5, 5}, 20, 20, chequered(8, 8), false);
  EXPECT_EQ(rasterise(canvas).pixels, rasterise(canvas).pixels);
  const std::string pdf = draw_pdf(canvas);
  EXPECT_EQ(pdf, draw_pdf(canvas));
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_EQ(pdf.find("CreationDate"), std::string::npos);             // it would change from second to second
  EXPECT_NE(pdf.find("/MediaBox [ 0 0 90 45 ]"), std::string::npos);  // 96 pixels are 72 points
}

TEST(Raster, ThreadsDrawAtOnceWhatOneDraws) {
  Canvas canvas(200, 60, "");
  canvas.text({10, 30}, "crank 12.5\u00B0", {.size = 14, .is_bold = true});
  canvas.text({10, 50}, "\u03B8* and more", {.size = 17, .has_halo = true});
  const std::vector<std::uint8_t> alone = rasterise(canvas).pixels;
  const std::string alone_pdf = draw_pdf(canvas);
  std::vector<std::thread> threads;
  std::array<bool, 4> is_same{};
  for (std::size_t number = 0; number < is_same.size(); ++number) {
    threads.emplace_back([&, number] {
      bool all_same = true;
      for (int i = 0; i < 20; ++i)
        all_same = all_same && rasterise(canvas).pixels == alone && draw_pdf(canvas) == alone_pdf;
      is_same.at(number) = all_same;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const bool same : is_same) EXPECT_TRUE(same);
}

}  // namespace
}  // namespace gdtslam
