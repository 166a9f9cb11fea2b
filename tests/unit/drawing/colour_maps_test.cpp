// Colour maps against CIELAB as its definition has it (CIE 15; sRGB by IEC 61966-2-1) and the dichromats of
// [Vienot1999], their matrices in linear sRGB.
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

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

double linear(std::uint8_t byte) {
  const double encoded = byte / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Triple linear(Colour colour) { return {linear(colour.red), linear(colour.green), linear(colour.blue)}; }

Triple times(const Matrix& matrix, const Triple& vector) {
  Triple product{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) product.at(i) += matrix.at(i).at(j) * vector.at(j);
  }
  return product;
}

Triple lab(const Triple& rgb) {
  constexpr Matrix kXyz{
      {{0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}}};
  const auto root = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const Triple xyz = times(kXyz, rgb);
  const double x = root(xyz[0] / 0.95047);
  const double y = root(xyz[1]);
  const double z = root(xyz[2] / 1.08883);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

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

TEST(ColourMaps, LightnessOfASequentialMapIsAStraightLine) {  // what sRGB cannot show would bend it
  for (const std::string& name : kSequential) {
    const ColourMap& map = colour_map(name);
    const double from = lab(linear(map.table().front()))[0];
    const double to = lab(linear(map.table().back()))[0];
    EXPECT_GT(std::fabs(to - from), 70.0) << name;
    for (std::size_t i = 0; i < 256; ++i) {
      const double expected = from + (to - from) * static_cast<double>(i) / 255.0;
      EXPECT_NEAR(lab(linear(map.table()[i]))[0], expected, 0.8) << name << " at " << i;
    }
  }
}

TEST(Colour, IsWrittenAsTheWebWritesIt) {
  EXPECT_EQ(hex_text(colour_for(0x0a1fe0)), "#0a1fe0");
  EXPECT_EQ(colour_for(0x123456), (Colour{0x12, 0x34, 0x56}));
}

}  // namespace
}  // namespace gdtslam
