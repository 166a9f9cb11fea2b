// The comparison that every golden of the viewer relies on.
#include "support/image_compare.hpp"

#include <algorithm>
#include <filesystem>

namespace {

using gdtslam::RgbaImage;
using gdtslam::test::difference_of;
using gdtslam::test::is_alike;

RgbaImage grey(std::uint32_t width, std::uint32_t height, std::uint8_t level) {
  RgbaImage image(width, height);
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = k % 4 == 3 ? 255 : level;
  return image;
}

TEST(ImageCompare, MeanAndShareAreThoseCountedByHand) {
  const RgbaImage a = grey(10, 10, 100);
  RgbaImage b = a;
  b.at(3, 4)[0] = 130;                                      // 30 in one of 400 channels
  for (std::size_t k = 0; k < 3; ++k) b.at(7, 7)[k] = 124;  // 24 thrice, not beyond the step
  const auto difference = difference_of(a, b, 24);
  EXPECT_DOUBLE_EQ(difference.mean, (30.0 + 3 * 24.0) / 400.0);
  EXPECT_DOUBLE_EQ(difference.share_clear, 0.01);
}

TEST(ImageCompare, ColourOfTransparentPixelsDoesNotCountTheirAlphaDoes) {
  RgbaImage a(2, 1);
  RgbaImage b(2, 1);
  b.at(0, 0)[0] = 200;
  EXPECT_TRUE(is_alike(a, b, {.mean = 0.0, .share_clear = 0.0}));
  b.at(1, 0)[3] = 255;
  EXPECT_FALSE(is_alike(a, b, {.mean = 1.0, .share_clear = 0.0}));
}

TEST(ImageCompare, SizesMustAgree) {
  EXPECT_FALSE(is_alike(grey(4, 4, 0), grey(4, 5, 0)));
  EXPECT_THROW(difference_of(grey(4, 4, 0), grey(4, 5, 0)), std::invalid_argument);
}

TEST(ImageCompare, PngKeepsOpaquePixelsAndAlpha) {
  RgbaImage image(37, 11);
  for (std::size_t k = 0; k < image.pixels.size(); ++k) image.pixels[k] = static_cast<std::uint8_t>(k * 37 % 256);
  for (std::uint32_t x = 0; x < image.width; ++x) image.at(x, 2)[3] = 255;
  const std::string path = ::testing::TempDir() + "image_compare_test.png";
  gdtslam::test::write_png(image, path);
  const RgbaImage back = gdtslam::test::read_png(path);
  std::filesystem::remove(path);
  ASSERT_EQ(back.width, image.width);
  ASSERT_EQ(back.height, image.height);
  EXPECT_TRUE(is_alike(back, image, {.mean = 0.0, .share_clear = 0.0}));
  EXPECT_TRUE(std::equal(image.at(0, 2), image.at(0, 2) + 4 * image.width, back.at(0, 2)));
}

TEST(ImageCompare, MissingGoldenFailsAndSaysWhereThePictureIs) {
  const auto result = gdtslam::test::matches_golden(grey(3, 3, 9), "no_such_golden");
  EXPECT_FALSE(result);
  EXPECT_NE(std::string(result.message()).find("GDTSLAM_UPDATE_GOLDENS"), std::string::npos) << result.message();
  const std::string evidence = GDTSLAM_BINARY_DIR "/tests/golden/no_such_golden.actual.png";
  ASSERT_TRUE(std::filesystem::exists(evidence));
  EXPECT_TRUE(is_alike(gdtslam::test::read_png(evidence), grey(3, 3, 9), {.mean = 0.0, .share_clear = 0.0}));
  std::filesystem::remove(evidence);
}

}  // namespace
