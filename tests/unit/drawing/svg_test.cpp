// SVG by Cairo: the same text for the same drawing, words for screen readers, well formed whatever the words are.
#include <gmock/gmock.h>

#include <memory>
#include <string>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::Not;

Canvas drawing_with_image(bool is_smooth) {
  const auto image = std::make_shared<RgbaImage>(2, 1);
  Canvas canvas(100, 50, "a < b & \"c\"\x1B");
  canvas.picture({1, 2}, 30, 40, image, is_smooth);
  canvas.text({1, 20}, "<c\x80> \xCE\xB8");
  canvas.upright_text({3, 40}, "up", {.has_halo = true});
  canvas.end_clip();  // of nothing
  canvas.begin_clip({10, 20}, 30, 40);
  canvas.line({0, 0}, {10, 1}, {.dashes = "4 3"});
  return canvas;
}

TEST(Svg, HasSizeTitleAndWords) {
  const std::string svg = draw_svg(drawing_with_image(true));
  EXPECT_THAT(svg, testing::StartsWith("<svg "));
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 100 50\""));
  EXPECT_THAT(svg, HasSubstr("<title>a &lt; b &amp; &quot;c&quot; </title>"));
  EXPECT_THAT(svg, HasSubstr("<desc>&lt;c\xEF\xBF\xBD&gt; \xCE\xB8\nup\n</desc>"));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
}

// Cairo names images by a count of the process.
TEST(Svg, IsTheSameTextEachTime) {
  const std::string first = draw_svg(drawing_with_image(false));
  EXPECT_EQ(draw_svg(drawing_with_image(false)), first);
  EXPECT_THAT(first, HasSubstr("xlink:href=\"data:image/png;base64,"));
  EXPECT_THAT(first, HasSubstr("image-rendering:pixelated"));
  EXPECT_THAT(draw_svg(drawing_with_image(true)), Not(HasSubstr("pixelated")));
}

TEST(Canvas, APlacedDrawingIsScaledAndMovedAsAWhole) {
  Canvas inner(50, 50, "inner");
  inner.begin_clip({0, 0}, 9, 9);
  inner.line({1, 1}, {2, 2}, {});
  inner.text({3, 3}, "x", {.size = 10.0});
  inner.circle({4, 4}, 1, std::nullopt);
  inner.end_clip();
  Canvas outer(100, 100, "outer");
  outer.place(inner, {10, 20}, 2.0);
  Canvas expected(100, 100, "outer");
  expected.begin_clip({10, 20}, 18, 18);
  expected.line({12, 22}, {14, 24}, {.width = 2.0});
  expected.text({16, 26}, "x", {.size = 20.0});
  expected.circle({18, 28}, 2, std::nullopt);
  expected.end_clip();
  EXPECT_EQ(draw_svg(outer), draw_svg(expected));
}

}  // namespace
}  // namespace gdtslam
