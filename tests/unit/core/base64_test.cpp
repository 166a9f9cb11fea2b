// Base64 against the examples of its standard.
#include "engine/core/base64.hpp"

#include <array>
#include <span>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

std::string base64(std::string_view bytes) {
  std::string out;
  append_base64(std::as_bytes(std::span(bytes)), out);
  return out;
}

// The vectors of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  constexpr std::string_view kText = "foobar";
  constexpr std::array<std::string_view, 7> kExpected{"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (std::size_t length = 0; length <= kText.size(); ++length) {
    EXPECT_EQ(base64(kText.substr(0, length)), kExpected.at(length));
  }
  EXPECT_EQ(base64("\xFB\xEF\xFF"), "++//");
}

}  // namespace
}  // namespace gdtslam
