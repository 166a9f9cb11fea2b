// text_width() against letters as Cairo sets them: the ink of "|words|" is wider than that of "||" by the words'
// advance.
#include <gtest/gtest.h>

#include <string>

#include "gdtslam/drawing/raster.hpp"

namespace gdtslam {
namespace {

constexpr double kTextSize = 40.0;

double ink_width(const std::string& words, bool is_bold) {
  Canvas canvas(1600, 80, "");
  canvas.text({20, 60}, words, {.size = kTextSize, .is_bold = is_bold});
  const RgbaImage image = raster_of(canvas);
  std::uint32_t left = image.width;
  std::uint32_t right = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (image.at(x, y)[3] < 100) continue;
      left = std::min(left, x);
      right = std::max(right, x);
    }
  }
  return right - left;
}

TEST(TextWidth, AgreesWithLettersOnThePage) {
  for (const bool is_bold : {false, true}) {
    for (const std::string words : {"elevation in m", "The quick brown fox jumps over the lazy dog", "0123456789",
                                    "WWWWWWWW", "iiiiiiiiiiiiiiii", "\u03B8* = 12.5\u00B0 \u00B1 0.3\u00B0",
                                    "\u03B1\u03B2\u03B3\u03B4 \u03A9\u03A3\u0394", "r\u00E9sum\u00E9 gr\u00F6\u00DFer",
                                    "\u221212.5 \u2264 x \u2192 \u221E", "p50\u2013p95 \u00B7 \u201Cquoted\u201D"}) {
      const double measured = ink_width("|" + words + "|", is_bold) - ink_width("||", is_bold);
      EXPECT_NEAR(text_width(words, kTextSize, is_bold) / measured, 1.0, 0.02) << words << (is_bold ? ", bold" : "");
    }
  }
}

TEST(TextWidth, GrowsWithTheSizeAndIsNothingForNothing) {
  EXPECT_EQ(text_width("", 13), 0.0);
  EXPECT_DOUBLE_EQ(text_width("abc", 26), 2.0 * text_width("abc", 13));
  EXPECT_GT(text_width("abc", 13, true), text_width("abc", 13));
}

}  // namespace
}  // namespace gdtslam
