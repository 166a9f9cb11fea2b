// Words that come from others, on their way into a page.
#include "page/page_escape.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>

#include "page/page_base64.hpp"

namespace gdtslam::page {
namespace {

constexpr std::string_view kUnknown = "\xEF\xBF\xBD";

TEST(PageEscape, ValidUtf8StaysAsItIs) {
  for (const std::string_view text : {"", "plain", "gr\xC3\xBC\xC3\x9F", "\xE2\x82\xAC", "\xF0\x9F\xA4\x96", "a\tb\nc",
                                      "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(clean_utf8(text), text);
  }
}

// How many U+FFFD stand for what is no UTF-8: one for each longest beginning of a sequence (Unicode 15, 3.9, D93b and
// table 3-11).
TEST(PageEscape, WhatIsNoUtf8IsReplacedAsBrowsersDo) {
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
  }
}

TEST(PageEscape, ControlCharactersAreReplaced) {
  EXPECT_EQ(clean_utf8(std::string("a\0b\x1B\x7F", 5)),
            "a" + std::string(kUnknown) + "b" + std::string(kUnknown) + std::string(kUnknown));
}

TEST(PageEscape, MarkupLosesItsMeaning) {
  EXPECT_EQ(html_text("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
  EXPECT_EQ(json_text("</script>&\"\\\n"), "\"\\u003c/script\\u003e\\u0026\\u0022\\u005c\\u000a\"");
}

TEST(PageEscape, NumbersReadBackAsTheSame) {
  for (const double value : {0.0, -0.1, 1.0 / 3.0, 5e8 + 1e-6, 1e300, -4.9e-324}) {
    EXPECT_EQ(std::strtod(json_number(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(json_number(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(json_number(std::numeric_limits<double>::infinity()), "null");
}

TEST(PageEscape, JsonHasCommasWhereTheyBelong) {
  JsonWriter json;
  json.open("", '{').number("a", 1.0).open("b", '[').number("", 2.0).text("", "c").open("", '{').close().close();
  json.open("d", '[').close().close();
  EXPECT_EQ(json.str(), R"({"a":1,"b":[2,"c",{}],"d":[]})");
}

// The vectors of RFC 4648, section 10.
TEST(PageBase64, IsThatOfTheStandard) {
  const std::string_view text = "foobar";
  const std::string_view expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (std::size_t length = 0; length <= text.size(); ++length) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
    std::string out = "=";
    append_base64(bytes, out);
    EXPECT_EQ(out, "=" + std::string(expected[length]));
  }
  std::string out;
  append_base64(std::vector<std::uint8_t>{0xFB, 0xEF, 0xFF}, out);
  EXPECT_EQ(out, "++//");
}

TEST(PageBase64, BytesAreLittleEndian) {
  ByteWriter bytes;
  bytes.u16(0x1234);
  bytes.f32(-2.5);  // 0xC0200000
  EXPECT_EQ(bytes.bytes(), (std::vector<std::uint8_t>{0x34, 0x12, 0x00, 0x00, 0x20, 0xC0}));
}

}  // namespace
}  // namespace gdtslam::page
