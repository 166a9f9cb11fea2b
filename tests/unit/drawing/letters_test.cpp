// Words that come from others, on their way into pictures, HTML and SVG: what a browser makes of them is what was
// given.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "engine/drawing/letters.hpp"

namespace gdtslam {
namespace {

TEST(Letters, ValidUtf8StaysAsItIs) {
  for (const std::string_view text :
       {"", "plain", "gr\xC3\xBC\xC3\x9F", "\xE2\x82\xAC", "\xF0\x9F\xA4\x96", "\xED\x9F\xBF", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(legible(text), text);
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

// How many U+FFFD stand for broken bytes: one for each longest beginning of a sequence (Unicode 15, 3.9, D93b and table
// 3-11). XML 1.0, production 2, forbids the last characters of the first plane, too.
TEST(Letters, BrokenBytesAreReplacedAsBrowsersDo) {
  for (const auto& [text, replaced] : std::initializer_list<std::pair<std::string, int>>{{"\x80", 1},
                                                                                         {"\xC0\xAF", 2},
                                                                                         {"\xE0\x80\xAF", 3},
                                                                                         {"\xED\xA0\x80", 3},
                                                                                         {"\xF4\x90\x80\x80", 4},
                                                                                         {"\xE2\x82", 1},
                                                                                         {"\xF0\x9F\xA4", 1},
                                                                                         {"\xFE\xFF", 2},
                                                                                         {"\xC3", 1},
                                                                                         {"\xF5\x80\x80\x80", 4}}) {
    std::string expected = "<";
    for (int k = 0; k < replaced; ++k) expected += kUnknownLetterBytes;
    EXPECT_EQ(legible("<" + text + ">"), expected + ">");
    EXPECT_FALSE(is_utf8("<" + text + ">"));
  }
  EXPECT_EQ(legible("\xEF\xBF\xBE\xEF\xBF\xBF"), std::string(kUnknownLetterBytes) + std::string(kUnknownLetterBytes));
  EXPECT_EQ(legible(std::string("a\0b\x1B\n\x7F", 6)), "a b   ");
}

TEST(Letters, MarkupLosesItsMeaning) {
  EXPECT_EQ(markup_text("<b a=\"1\" c='2'>&amp;"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;amp;");
}

}  // namespace
}  // namespace gdtslam
