// Words that come from others, on their way into HTML and SVG: what a browser makes of them is what was given.
#include "engine/drawing/markup.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "engine/drawing/letters.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kUnknown = "\xEF\xBF\xBD";

TEST(Markup, ValidUtf8StaysAsItIs) {
  for (const std::string_view text : {"", "plain", "gr\xC3\xBC\xC3\x9F", "\xE2\x82\xAC", "\xF0\x9F\xA4\x96", "a\tb\nc",
                                      "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(clean_utf8(text), text);
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

// How many U+FFFD stand for what is no UTF-8: one for each longest beginning of a sequence (Unicode 15, 3.9, D93b and
// table 3-11).
TEST(Markup, WhatIsNoUtf8IsReplacedAsBrowsersDo) {
  struct Case {
    std::string_view text;
    int replaced;
  };
  for (const Case& one : {Case{"\x80", 1}, Case{"\xC0\xAF", 2}, Case{"\xE0\x80\xAF", 3}, Case{"\xED\xA0\x80", 3},
                          Case{"\xF4\x90\x80\x80", 4}, Case{"\xE2\x82", 1}, Case{"\xF0\x9F\xA4", 1},
                          Case{"\xFE\xFF", 2}, Case{"\xC3", 1}, Case{"\xF5\x80\x80\x80", 4}}) {
    std::string expected = "<";
    for (int k = 0; k < one.replaced; ++k) expected += kUnknown;
    EXPECT_EQ(clean_utf8("<" + std::string(one.text) + ">"), expected + ">");
    EXPECT_FALSE(is_utf8("<" + std::string(one.text) + ">"));
    EXPECT_FALSE(is_utf8(one.text));
  }
}

TEST(Markup, ControlCharactersAreReplaced) {
  EXPECT_EQ(clean_utf8(std::string("a\0b\x1B\x7F", 5)),
            "a" + std::string(kUnknown) + "b" + std::string(kUnknown) + std::string(kUnknown));
  for (char control = 1; control < 0x20; ++control) {
    const std::string text(1, control);
    EXPECT_EQ(clean_utf8(text), control == '\n' || control == '\t' ? text : kUnknown) << static_cast<int>(control);
  }
}

// XML 1.0, production 2: the last characters of the first plane are none of its own.
TEST(Markup, WhatXmlForbidsIsReplaced) {
  EXPECT_EQ(clean_utf8("\xEF\xBF\xBD\xEF\xBF\xBE\xEF\xBF\xBF"),
            std::string(kUnknown) + std::string(kUnknown) + std::string(kUnknown));
}

TEST(Markup, LosesItsMeaning) {
  EXPECT_EQ(markup_text("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
  EXPECT_EQ(markup_text("&amp;\x01"), "&amp;amp;" + std::string(kUnknown));
  EXPECT_EQ(markup_text("\xC3\xBC\tm\n"), "\xC3\xBC\tm\n");
}

}  // namespace
}  // namespace gdtslam
