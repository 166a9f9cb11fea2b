// Colour maps by name, and the colours at and beyond their ends.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

const std::vector<std::string> kSequential{"lagoon", "ember", "tide", "glow"};

TEST(ColourMaps, EachHasANameOfItsOwnADocAnd256Colours) {
  std::set<std::string_view> names;
  for (const ColourMap& map : colour_maps()) {
    EXPECT_TRUE(names.insert(map.name()).second) << map.name();
    EXPECT_FALSE(map.doc().empty());
    EXPECT_EQ(map.table().size(), 256U);
    EXPECT_EQ(&colour_map(map.name()), &map);
  }
  EXPECT_EQ(colour_maps().front().name(), "lagoon");
  EXPECT_EQ(names.size(), kSequential.size());
}

TEST(ColourMaps, AnUnknownNameIsAnsweredWithTheNames) {
  try {
    (void)colour_map("rainbow");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("rainbow"), testing::HasSubstr("lagoon, ember")));
  }
}

TEST(ColourMaps, ValuesOutsideAreClampedAndNoNumberIsUnknown) {
  for (const ColourMap& map : colour_maps()) {
    EXPECT_EQ(map.at(-1.0), map.table().front());
    EXPECT_EQ(map.at(std::numeric_limits<double>::infinity()), map.table().back());
    EXPECT_EQ(map.at(100.0 / 255.0), map.table()[100]);
    EXPECT_EQ(map.at(std::numeric_limits<double>::quiet_NaN()), map.unknown());
    for (const Colour& colour : map.table()) EXPECT_FALSE(colour == map.unknown()) << map.name();
  }
}

TEST(Colour, IsWrittenAsTheWebWritesIt) {
  EXPECT_EQ(hex_text(colour_for(0x0a1fe0)), "#0a1fe0");
  EXPECT_EQ(colour_for(0x123456), (Colour{0x12, 0x34, 0x56}));
}

}  // namespace
}  // namespace gdtslam
