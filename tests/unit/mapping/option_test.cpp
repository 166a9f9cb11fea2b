
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "gdtslam/core/units.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

enum class Colour : std::uint8_t { kRed, kGreen };
constexpr std::array<std::string_view, 2> kColours{"red", "green"};

TEST(Choice, SetsByNameAndRefusesOthers) {
  Colour colour = Colour::kRed;
  const Choice choice(colour, kColours);
  EXPECT_EQ(choice.get(), "red");
  EXPECT_TRUE(choice.set("green"));
  EXPECT_EQ(colour, Colour::kGreen);
  EXPECT_EQ(choice.get(), "green");
  for (const char* const wrong : {"blue", "Green", "", "gree", "greens"}) {
    EXPECT_FALSE(choice.set(wrong)) << wrong;
    EXPECT_EQ(colour, Colour::kGreen);
  }
}

struct Values {
  double length_m = 0.5;
  std::int32_t count = 3;
  bool on = true;
  Colour colour = Colour::kRed;
};

std::vector<Option> table_of(Values& v) {
  return {{"a.length", "a length", Unit::kMetre, 0.25, 1.0, &v.length_m},
          {"a.count", "a count", Unit::kNone, 1, 4, &v.count},
          {"a.on", "a switch", Unit::kNone, 0, 0, &v.on},
          {"a.colour", "a choice", Unit::kNone, 0, 0, Choice(v.colour, kColours)}};
}

TEST(Violations, BoundsAreAllowedThemselves) {
  Values v;
  for (const double length_m : {0.25, 1.0}) {
    for (const std::int32_t count : {1, 4}) {
      v.length_m = length_m;
      v.count = count;
      EXPECT_THAT(violations(table_of(v)), IsEmpty());
    }
  }
}

TEST(Violations, EachNamesPathValueAndBounds) {
  Values v{.length_m = std::nextafter(0.25, 0.0), .count = 5};
  EXPECT_THAT(violations(table_of(v)), ElementsAre(HasSubstr("a.length: 0.24999999999999997 m is not in 0.25 m to 1 m"),
                                                   HasSubstr("a.count: 5 is not in 1 to 4")));
}

TEST(Violations, WhatIsNoNumberViolates) {
  Values v{.length_m = std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(violations(table_of(v)).size(), 1u);
}

// The rows of the real tables: every default is allowed, no path twice, every option says what it does.
TEST(OptionTables, AreSound) {
  MapperConfig mapper;
  OccupancyConfig occupancy;
  std::vector<Option> table = option_table(mapper);
  for (const Option& option : option_table(occupancy)) table.push_back(option);
  EXPECT_THAT(violations(table), IsEmpty());
  std::set<std::string_view> paths;
  for (const Option& option : table) {
    EXPECT_TRUE(paths.insert(option.path).second) << option.path;
    EXPECT_NE(option.path.find('.'), std::string_view::npos) << option.path;
    EXPECT_FALSE(option.doc.empty()) << option.path;
    EXPECT_EQ(option.doc.find('|'), std::string_view::npos) << option.path << ": it stands in a Markdown table";
  }
}

}  // namespace
}  // namespace gdtslam
