#include "gdtslam/core/units.hpp"

#include <clocale>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

std::optional<double> parsed(std::string_view text, Unit unit) { return parse_quantity(text, unit, nullptr); }

std::string reason(std::string_view text, Unit unit) {
  std::string why;
  EXPECT_FALSE(parse_quantity(text, unit, &why).has_value()) << text;
  return why;
}

TEST(ParseQuantity, ReadsUnits) {
  EXPECT_EQ(parsed("5 cm", Unit::kMetre), 0.05);
  EXPECT_EQ(parsed("0.05 m", Unit::kMetre), 0.05);
  EXPECT_EQ(parsed("12mm", Unit::kMetre), 0.012);
  EXPECT_EQ(parsed("1.5 km", Unit::kMetre), 1500.0);
  EXPECT_EQ(parsed("180 deg", Unit::kRadian), std::numbers::pi);
  EXPECT_EQ(parsed("180\u00B0", Unit::kRadian), std::numbers::pi);
  EXPECT_EQ(parsed("0.03 rad", Unit::kRadian), 0.03);
  EXPECT_EQ(parsed("30 mrad", Unit::kRadian), 0.03);
  EXPECT_EQ(parsed("0.5 turns", Unit::kRadian), std::numbers::pi);
  EXPECT_EQ(parsed("250 ms", Unit::kSecond), 0.25);
  EXPECT_EQ(parsed("2 min", Unit::kSecond), 120.0);
  EXPECT_EQ(parsed("1 h", Unit::kSecond), 3600.0);
  EXPECT_EQ(parsed("3 cells", Unit::kCell), 3.0);
  EXPECT_EQ(parsed("1 cell", Unit::kCell), 1.0);
  EXPECT_EQ(parsed("30 %", Unit::kShare), 0.3);
  EXPECT_EQ(parsed("0.3", Unit::kShare), 0.3);
  EXPECT_EQ(parsed("42", Unit::kNone), 42.0);
}

TEST(ParseQuantity, BareNumberIsInTheBaseUnit) {
  for (const Unit unit : {Unit::kNone, Unit::kMetre, Unit::kRadian, Unit::kSecond, Unit::kCell, Unit::kShare}) {
    EXPECT_EQ(parsed("0.125", unit), 0.125);
  }
}

// 7 * 0.01 and 29 * 0.001 are no nearest doubles; the decimal point is moved instead.
TEST(ParseQuantity, RoundsOnce) {
  EXPECT_EQ(parsed("7 cm", Unit::kMetre), 0.07);
  EXPECT_EQ(parsed("29 mm", Unit::kMetre), 0.029);
  EXPECT_EQ(parsed("55 %", Unit::kShare), 0.55);
  EXPECT_EQ(parsed("1.1e1 cm", Unit::kMetre), 0.11);
  EXPECT_EQ(parsed("1e310 ns", Unit::kSecond), 1e301) << "in range after the unit is applied";
}

TEST(ParseQuantity, ReadsEveryFormOfANumber) {
  EXPECT_EQ(parsed("  -1.5e+2\tcm ", Unit::kMetre), -1.5);
  EXPECT_EQ(parsed("+2", Unit::kNone), 2.0);
  EXPECT_EQ(parsed(".5", Unit::kNone), 0.5);
  EXPECT_EQ(parsed("5.", Unit::kNone), 5.0);
  EXPECT_EQ(parsed("1E-3", Unit::kNone), 0.001);
  EXPECT_EQ(parsed("-0", Unit::kNone), 0.0);
}

TEST(ParseQuantity, SaysWhyNot) {
  EXPECT_THAT(reason("", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason("cm", Unit::kMetre), HasSubstr("'cm' does not start with a decimal number"));
  EXPECT_THAT(reason("-", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason(".", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason("+-1", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason("nan", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason("inf", Unit::kMetre), HasSubstr("number"));
  EXPECT_THAT(reason("5 deg", Unit::kMetre), HasSubstr("'deg' does not fit here; write one of m, km"));
  EXPECT_THAT(reason("5 m", Unit::kNone), HasSubstr("write a bare number"));
  EXPECT_THAT(reason("5 metres", Unit::kMetre), HasSubstr("'metres'"));
  EXPECT_THAT(reason("5 M", Unit::kMetre), HasSubstr("'M'"));
  EXPECT_THAT(reason("5,5", Unit::kNone), HasSubstr("',5'"));
  EXPECT_THAT(reason("5 a\nb", Unit::kMetre), HasSubstr("'a?b'"));  // the reason is one line whatever was quoted
  EXPECT_THAT(reason("1 2", Unit::kNone), HasSubstr("'2'"));
  EXPECT_THAT(reason("0x10", Unit::kNone), HasSubstr("'x10'"));
  EXPECT_THAT(reason("5e", Unit::kNone), HasSubstr("'e'"));
  EXPECT_THAT(reason("1e400", Unit::kNone), HasSubstr("range"));
  EXPECT_THAT(reason("1e308 h", Unit::kSecond), HasSubstr("range"));
  EXPECT_THAT(reason("1e99999999999999999999", Unit::kNone), HasSubstr("range"));
}

TEST(ParseStatedQuantity, RefusesABareNumberWhereUnitsDiffer) {
  std::string why;
  EXPECT_EQ(parse_stated_quantity("50", Unit::kMetre, &why), std::nullopt);
  EXPECT_EQ(why, "'50' needs a unit: 50 cm, 50 m");
  EXPECT_EQ(parse_stated_quantity(" -9e1 ", Unit::kRadian, &why), std::nullopt);
  EXPECT_EQ(why, "'-9e1' needs a unit: -9e1 deg, -9e1 rad");
  EXPECT_EQ(parse_stated_quantity("2.", Unit::kSecond, &why), std::nullopt);
  EXPECT_EQ(why, "'2.' needs a unit: 2. ms, 2. s");
  EXPECT_EQ(parse_stated_quantity("50 deg", Unit::kMetre, &why), std::nullopt);
  EXPECT_THAT(why, HasSubstr("'deg' does not fit here"));
}

TEST(ParseStatedQuantity, TakesUnitsAndNothingAndWhatHasOneUnitOnly) {
  EXPECT_EQ(parse_stated_quantity("50cm", Unit::kMetre, nullptr), 0.5);
  EXPECT_EQ(parse_stated_quantity("250 ms ", Unit::kSecond, nullptr), 0.25);
  EXPECT_EQ(parse_stated_quantity("0", Unit::kMetre, nullptr), 0.0);
  EXPECT_EQ(parse_stated_quantity("-0.0", Unit::kRadian, nullptr), 0.0);
  EXPECT_EQ(parse_stated_quantity("3", Unit::kCell, nullptr), 3.0);
  EXPECT_EQ(parse_stated_quantity("0.3", Unit::kShare, nullptr), 0.3);
  EXPECT_EQ(parse_stated_quantity("7", Unit::kNone, nullptr), 7.0);
}

TEST(FormatQuantity, IsShortAndInTheBaseUnit) {
  EXPECT_EQ(format_quantity(0.05, Unit::kMetre), "0.05 m");
  EXPECT_EQ(format_quantity(0.1, Unit::kRadian), "0.1 rad");
  EXPECT_EQ(format_quantity(10.0 * kPi / 180.0, Unit::kRadian), "10 deg");
  EXPECT_EQ(format_quantity(-kPi / 2.0, Unit::kRadian), "-90 deg");
  EXPECT_EQ(format_quantity(0.0, Unit::kRadian), "0 rad");
  EXPECT_EQ(format_quantity(2.0, Unit::kSecond), "2 s");
  EXPECT_EQ(format_quantity(3.0, Unit::kCell), "3 cells");
  EXPECT_EQ(format_quantity(0.3, Unit::kShare), "0.3");
  EXPECT_EQ(format_quantity(-1e-300, Unit::kNone), "-1e-300");
}

TEST(ShowQuantity, HasAnglesInDegreesAndWholeNumbersInFull) {
  EXPECT_EQ(show_quantity(0.035, Unit::kRadian), "2.00535 deg");  // 0.035 * 180 / 3.14159265 = 2.0053523
  EXPECT_EQ(show_quantity(0.0, Unit::kRadian), "0 deg");
  EXPECT_EQ(show_quantity(kPi, Unit::kRadian), "180 deg");
  EXPECT_EQ(show_quantity(1e-4, Unit::kRadian), "0.00572958 deg");
  EXPECT_EQ(show_quantity(100000.0, Unit::kNone), "100000");
  EXPECT_EQ(show_quantity(-1e10, Unit::kSecond), "-10000000000 s");
  EXPECT_EQ(show_quantity(0.025, Unit::kMetre), "0.025 m");
  EXPECT_EQ(show_quantity(0.5, Unit::kShare), "0.5");
}

TEST(Units, IgnoreTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  // Where the comma locale is not installed the test still checks the C locale.
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "C"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) {
      EXPECT_EQ(parsed("1.5 cm", Unit::kMetre), 0.015) << name;
      EXPECT_EQ(format_quantity(1.5, Unit::kMetre), "1.5 m") << name;
    }
  }
  std::setlocale(LC_ALL, before.c_str());
}

}  // namespace
}  // namespace gdtslam
