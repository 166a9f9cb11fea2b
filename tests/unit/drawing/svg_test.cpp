// SVG text against what its specification says of each element; base64 against the examples of RFC 4648.
#include <gmock/gmock.h>

#include <memory>
#include <string>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Svg, HasItsSizeAndTitleAndNoPage) {
  const std::string svg = svg_of(Canvas(640, 480, "a < b & \"c\""));
  EXPECT_THAT(svg, testing::StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"480\" "
                                       "viewBox=\"0 0 640 480\""));
  EXPECT_THAT(svg, HasSubstr("<title>a &lt; b &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(svg, Not(HasSubstr("<rect")));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
}

TEST(Svg, DrawsEachShape) {
  Canvas canvas(100, 100, "shapes");
  canvas.rectangle({1, 2}, 30, 40, Fill{colour_for(0xff0000), 0.5}, Pen{.colour = colour_for(0x00ff00), .width = 2.0},
                   3);
  canvas.line({0, 0}, {10.005, -0.001}, {.colour = colour_for(0x0000ff), .opacity = 0.25, .dashes = "4 3"});
  canvas.polyline({{0, 0}, {1, 1}, {2, 0}}, {});
  canvas.polygon({{0, 0}, {1, 1}, {2, 0}}, Fill{colour_for(0x123456)});
  canvas.circle({5, 6}, 7, std::nullopt, Pen{.colour = colour_for(0xabcdef)});
  canvas.circle({5, 6}, 8, Fill{colour_for(0xabcdef)});
  const std::string svg = svg_of(canvas);
  EXPECT_THAT(svg,
              HasSubstr("<rect x=\"1.00\" y=\"2.00\" width=\"30.00\" height=\"40.00\" rx=\"3.00\" fill=\"#ff0000\" "
                        "fill-opacity=\"0.50\" stroke=\"#00ff00\" stroke-width=\"2.00\"/>"));
  EXPECT_THAT(svg, HasSubstr("<line x1=\"0.00\" y1=\"0.00\" x2=\"10.01\" y2=\"0.00\" stroke=\"#0000ff\" "
                             "stroke-width=\"1.00\" stroke-opacity=\"0.25\" stroke-dasharray=\"4 3\"/>"));
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"0.00,0.00 1.00,1.00 2.00,0.00\" fill=\"none\""));
  EXPECT_THAT(svg, HasSubstr("<polygon points=\"0.00,0.00 1.00,1.00 2.00,0.00\" fill=\"#123456\""));
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"5.00\" cy=\"6.00\" r=\"7.00\" fill=\"none\" stroke=\"#abcdef\""));
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"5.00\" cy=\"6.00\" r=\"8.00\" fill=\"#abcdef\"/>"));
}

TEST(Svg, WritesWords) {
  Canvas canvas(100, 100, "words");
  canvas.text({1, 2}, "crank 3 < 4\n\x01", {.size = 20, .anchor = Anchor::kEnd, .is_bold = true});
  canvas.upright_text({3, 4}, "up", {.anchor = Anchor::kMiddle, .has_halo = true, .halo = colour_for(0x010203)});
  const std::string svg = svg_of(canvas);
  EXPECT_THAT(svg,
              HasSubstr("font-size=\"20.00\" fill=\"#22262b\" text-anchor=\"end\" font-weight=\"600\">crank 3 &lt; "
                        "4  </text>"));
  EXPECT_THAT(svg, HasSubstr("text-anchor=\"middle\" stroke=\"#010203\" stroke-width=\"4\" paint-order=\"stroke\" "
                             "transform=\"rotate(-90 3.00 4.00)\">up</text>"));
}

TEST(Svg, IsUtf8WhateverTheWordsAre) {
  Canvas canvas(10, 10, "");
  canvas.text({0, 0}, "\xCE\xB8* 5\xC2\xB0");  // right
  canvas.text({0, 0},
              "a\xFF"
              "b\xC0\xAF"
              "c\xED\xA0\x80");  // no lead byte, overlong, half of a surrogate pair
  canvas.text({0, 0}, "cut\xE2\x82");
  const std::string svg = svg_of(canvas);
  const std::string wrong = "\xEF\xBF\xBD";
  EXPECT_THAT(svg, HasSubstr(">\xCE\xB8* 5\xC2\xB0</text>"));
  EXPECT_THAT(svg, HasSubstr(">a" + wrong + "b" + wrong + wrong + "c" + wrong + wrong + wrong + "</text>"));
  EXPECT_THAT(svg, HasSubstr(">cut" + wrong + "</text>"));  // one for a longest beginning, as browsers count
}

TEST(Svg, HoldsPicturesAsBase64) {
  const auto image = std::make_shared<RgbaImage>(2, 1);
  for (const auto& [bytes, text] : {std::pair{"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}}) {
    Canvas canvas(10, 10, "");
    canvas.picture({1, 2}, 3, 4, image, false);
    const std::string svg = svg_of(canvas, [bytes = bytes](const RgbaImage& given) {
      EXPECT_EQ(given.width, 2U);
      return std::string(bytes);
    });
    EXPECT_THAT(svg,
                HasSubstr("<image x=\"1.00\" y=\"2.00\" width=\"3.00\" height=\"4.00\" preserveAspectRatio=\"none\" "
                          "style=\"image-rendering:pixelated\" href=\"data:image/png;base64," +
                          std::string(text) + "\"/>"));
  }
  Canvas canvas(10, 10, "");
  canvas.picture({1, 2}, 3, 4, image);
  EXPECT_THROW((void)svg_of(canvas), Error);
}

TEST(Svg, ClipsAreNestedAndAlwaysClosed) {
  Canvas canvas(100, 100, "clips");
  canvas.end_clip();  // of nothing
  canvas.begin_clip({10, 20}, 30, 40);
  canvas.begin_clip({15, 25}, 5, 5);
  canvas.end_clip();
  canvas.line({0, 0}, {1, 1}, {});
  const std::string svg = svg_of(canvas);
  EXPECT_THAT(svg, HasSubstr("<svg x=\"10.00\" y=\"20.00\" width=\"30.00\" height=\"40.00\" "
                             "viewBox=\"10.00 20.00 30.00 40.00\">"));
  EXPECT_EQ(count_of(svg, "<svg "), 3U);
  EXPECT_EQ(count_of(svg, "</svg>"), 3U);
}

TEST(Canvas, APlacedDrawingMovesAsAWhole) {
  Canvas inner(50, 50, "inner");
  inner.begin_clip({0, 0}, 9, 9);
  inner.line({1, 1}, {2, 2}, {});
  inner.text({3, 3}, "x");
  inner.circle({4, 4}, 1, std::nullopt);
  inner.end_clip();
  Canvas outer(100, 100, "outer");
  outer.place(inner, {10, 20});
  Canvas expected(100, 100, "outer");
  expected.begin_clip({10, 20}, 9, 9);
  expected.line({11, 21}, {12, 22}, {});
  expected.text({13, 23}, "x");
  expected.circle({14, 24}, 1, std::nullopt);
  expected.end_clip();
  EXPECT_EQ(svg_of(outer), svg_of(expected));
}

}  // namespace
}  // namespace gdtslam
