// Words that come from others, on their way into a page, and its bytes.
#include "engine/drawing/page/page_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace gdtslam::page {
namespace {

using ::testing::HasSubstr;

TEST(PageWriter, JsonHoldsNoMarkupAndReadsBackAsTheSame) {
  const Json json{
      {"text", "</script>&\"\\\n"}, {"number", 1.0 / 3.0}, {"none", std::numeric_limits<double>::quiet_NaN()}};
  const std::string text = json_text(json);
  EXPECT_EQ(text.find_first_of("<>&\n"), std::string::npos) << text;
  const Json read = Json::parse(text);
  EXPECT_EQ(read["text"], json["text"]);
  EXPECT_EQ(read["number"], json["number"]);
  EXPECT_TRUE(read["none"].is_null());
}

TEST(PageWriter, BytesAreLittleEndian) {
  ByteWriter bytes;
  bytes.u16(0x1234);
  bytes.f32(-2.5);  // 0xC0200000
  EXPECT_EQ(bytes.bytes(), (std::vector<std::uint8_t>{0x34, 0x12, 0x00, 0x00, 0x20, 0xC0}));
}

TEST(PageWriter, NoTextIsTakenForAMarkOfThePage) {
  PageData data;
  data.description = {{"title", "{{program}} {{title}} <b>"}};
  add_element(data, "dots", std::vector<std::uint8_t>{1, 2, 3});
  const std::string page = page_text(data, "img-src 'self'");
  EXPECT_THAT(page, HasSubstr("<title>{{program}} {{title}} &lt;b&gt;</title>"));
  EXPECT_THAT(page, HasSubstr("id=\"dots\">AQID</script>"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("form-action 'none'; img-src 'self'\""));
}

}  // namespace
}  // namespace gdtslam::page
