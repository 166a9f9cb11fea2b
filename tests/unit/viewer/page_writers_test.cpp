// Words that come from others, on their way into a page.
#include "viewer/page/page_writers.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>

namespace gdtslam::page {
namespace {

TEST(PageEscape, JsonStringsHoldNoMarkupAndNoControls) {
  EXPECT_EQ(json_text("</script>&\"\\\n"), "\"\\u003c/script\\u003e\\u0026\\u0022\\u005c\\u000a\"");
  EXPECT_EQ(json_text("a\x1B\x80"), "\"a\xEF\xBF\xBD\xEF\xBF\xBD\"");
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

TEST(PageBytes, BytesAreLittleEndian) {
  ByteWriter bytes;
  bytes.u16(0x1234);
  bytes.f32(-2.5);  // 0xC0200000
  EXPECT_EQ(bytes.bytes(), (std::vector<std::uint8_t>{0x34, 0x12, 0x00, 0x00, 0x20, 0xC0}));
}

}  // namespace
}  // namespace gdtslam::page
