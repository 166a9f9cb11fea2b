// Decimal numbers against the C library, which rounds correctly, and against what IEEE 754 says.
#include "engine/io/decimal.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

double parsed(const std::string& text) {
  double value = -12345.0;
  const char* const stop = parse_double(text.data(), text.data() + text.size(), value);
  EXPECT_EQ(stop, text.data() + text.size()) << text;
  return value;
}

TEST(Decimal, ReadsPlusInfinityAndNan) {
  EXPECT_EQ(parsed("+1.5"), 1.5);
  EXPECT_EQ(parsed("inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parsed("-inf"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(parsed("nan")));
  EXPECT_TRUE(std::isnan(parsed("NaN")));
}

TEST(Decimal, RefusesWhatIsNoNumber) {
  for (const std::string text : {"", "-", "+", ".", "e5", "x", "--1", "+-1", "- 1", "-.", "+.e3"}) {
    double value = 0.0;
    EXPECT_EQ(parse_double(text.data(), text.data() + text.size(), value), nullptr) << text;
  }
}

TEST(Decimal, ReadsWholeNumbers) {
  std::int64_t value = 0;
  const auto parse = [&value](const std::string& text) {
    return parse_int64(text.data(), text.data() + text.size(), value) == text.data() + text.size();
  };
  EXPECT_TRUE(parse("-9223372036854775808"));
  EXPECT_EQ(value, std::numeric_limits<std::int64_t>::min());
  EXPECT_TRUE(parse("+12"));
  EXPECT_EQ(value, 12);
  EXPECT_FALSE(parse("9223372036854775808"));
  EXPECT_FALSE(parse("+-1"));
  EXPECT_FALSE(parse(""));
}

// What is too large or too small for a double is told by the digits before the point, or by the sign of the exponent.
TEST(Decimal, TheSideOfTheRangeIsToldByDigitsAndExponent) {
  constexpr double kDecimalInfinity = std::numeric_limits<double>::infinity();
  const std::string zeros(400, '0');
  EXPECT_EQ(parsed("1" + zeros + ".5"), kDecimalInfinity);
  EXPECT_EQ(parsed("9" + zeros + ".5"), kDecimalInfinity);
  EXPECT_EQ(parsed("-1" + zeros + ".0"), -kDecimalInfinity);
  EXPECT_EQ(parsed("1E-999"), 0.0);
  EXPECT_EQ(parsed("0.5E+999"), kDecimalInfinity);
  EXPECT_EQ(parsed("1.5e-999"), 0.0);
  EXPECT_EQ(parsed("-0." + zeros + "1"), 0.0);
  EXPECT_TRUE(std::signbit(parsed("-1e-999")));
}

}  // namespace
}  // namespace gdtslam
