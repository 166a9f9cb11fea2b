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

double distance(const Triple& one, const Triple& other) {
  return std::sqrt(std::pow(one[0] - other[0], 2) + std::pow(one[1] - other[1], 2) + std::pow(one[2] - other[2], 2));
}

/// Largest over smallest step of so many steps between two entries.
double unevenness(const ColourMap& map, std::size_t from, std::size_t to, std::size_t step) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t i = from; i + step <= to; i += step) {
    const double size = distance(lab(linear(map.table()[i])), lab(linear(map.table()[i + step])));
    least = std::min(least, size);
    most = std::max(most, size);
  }
  return most / least;
}

const std::vector<std::string> kSequential{"lagoon", "ember", "tide", "grey", "glow"};
const std::vector<std::string> kDiverging{"blue-red", "green-purple"};

/// Entries of the tables that matplotlib 3.6 publishes, none of them one that the maps are made from but the ends.
struct PublishedEntries {
  std::string name;
  std::vector<std::pair<std::size_t, std::uint32_t>> entries;
};
const std::vector<PublishedEntries> kPublished{{"viridis",
                                                {{0, 0x440154},
                                                 {7, 0x460b5e},
                                                 {37, 0x46337f},
                                                 {67, 0x39558c},
                                                 {97, 0x2c738e},
                                                 {128, 0x21918c},
                                                 {157, 0x25ac82},
                                                 {187, 0x54c568},
                                                 {217, 0x9bd93c},
                                                 {247, 0xeae51a},
                                                 {255, 0xfde725}}},
                                               {"magma",
                                                {{0, 0x000004},
                                                 {7, 0x03030f},
                                                 {37, 0x241253},
                                                 {67, 0x56147d},
                                                 {97, 0x842681},
                                                 {128, 0xb73779},
                                                 {157, 0xe34e65},
                                                 {187, 0xfa7f5e},
                                                 {217, 0xfeb77e},
                                                 {247, 0xfceeb0},
                                                 {255, 0xfcfdbf}}},
                                               {"inferno",
                                                {{0, 0x000004},
                                                 {7, 0x030210},
                                                 {37, 0x290b55},
                                                 {67, 0x5c126e},
                                                 {97, 0x8c2369},
                                                 {128, 0xbc3754},
                                                 {157, 0xe15635},
                                                 {187, 0xf8850f},
                                                 {217, 0xfbbe23},
                                                 {247, 0xf3f586},
                                                 {255, 0xfcffa4}}},
                                               {"plasma",
                                                {{0, 0x0d0887},
                                                 {7, 0x20068f},
                                                 {37, 0x5502a4},
                                                 {67, 0x8305a7},
                                                 {97, 0xab2494},
                                                 {128, 0xcc4778},
                                                 {157, 0xe4695e},
                                                 {187, 0xf68f44},
                                                 {217, 0xfeba2c},
                                                 {247, 0xf5eb27},
                                                 {255, 0xf0f921}}},
                                               {"turbo",
                                                {{0, 0x30123b},
                                                 {7, 0x38276d},
                                                 {37, 0x4778f0},
                                                 {67, 0x23c3e4},
                                                 {97, 0x35f394},
                                                 {128, 0xa4fc3c},
                                                 {157, 0xe9d539},
                                                 {187, 0xfd8d27},
                                                 {217, 0xdd3d08},
                                                 {247, 0x950d01},
                                                 {255, 0x7a0403}}}};

TEST(ColourMaps, EachHasANameOfItsOwnADocAnd256Colours) {
  std::set<std::string_view> names;
  for (const ColourMap& map : colour_maps()) {
    EXPECT_TRUE(names.insert(map.name()).second) << map.name();
    EXPECT_FALSE(map.doc().empty());
    EXPECT_EQ(map.table().size(), 256U);
    EXPECT_EQ(&colour_map(map.name()), &map);
  }
  EXPECT_EQ(colour_maps().front().name(), "lagoon");
  EXPECT_EQ(names.size(), kSequential.size() + kDiverging.size() + 1U + kPublished.size());
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

TEST(ColourMaps, StepsOfASequentialMapLookEquallyLarge) {
  for (const std::string& name : kSequential) EXPECT_LT(unevenness(colour_map(name), 0, 255, 15), 1.3) << name;
}

TEST(ColourMaps, EverySequentialMapIsReadableByEveryEye) {
  constexpr std::array kEyes{
      Matrix{{{0.11238, 0.88762, 0.0}, {0.11238, 0.88762, 0.0}, {0.00401, -0.00401, 1.0}}},   // no red cones
      Matrix{{{0.29275, 0.70725, 0.0}, {0.29275, 0.70725, 0.0}, {-0.02234, 0.02234, 1.0}}},   // no green cones
      Matrix{{{1.0, 0.14461, -0.14461}, {0.0, 0.85924, 0.14076}, {0.0, 0.85924, 0.14076}}}};  // no blue cones
  for (const std::string& name : kSequential) {
    const ColourMap& map = colour_map(name);
    for (std::size_t eye = 0; eye < kEyes.size(); ++eye) {
      const bool rises = lab(linear(map.table().front()))[0] < lab(linear(map.table().back()))[0];
      double last = rises ? -2.0 : 102.0;
      for (std::size_t i = 0; i < 256; i += 15) {
        Triple seen = times(kEyes.at(eye), linear(map.table()[i]));
        for (double& part : seen) part = std::max(0.0, part);
        const double lightness = lab(seen)[0];
        EXPECT_GT(rises ? lightness - last : last - lightness, 1.0) << name << ", eye " << eye << ", at " << i;
        last = lightness;
      }
    }
  }
}

TEST(ColourMaps, ADivergingMapFallsEvenlyFromItsLightMiddle) {
  for (const std::string& name : kDiverging) {
    const ColourMap& map = colour_map(name);
    EXPECT_EQ(map.table()[127], map.table()[128]) << name;
    EXPECT_LT(unevenness(map, 0, 127, 12), 1.3) << name;
    EXPECT_LT(unevenness(map, 128, 255, 12), 1.3) << name;
    const Triple low = lab(linear(map.table().front()));
    const Triple high = lab(linear(map.table().back()));
    EXPECT_NEAR(low[0], high[0], 1.0) << name;
    EXPECT_GT(lab(linear(map.table()[127]))[0] - low[0], 50.0) << name;
    EXPECT_GT(distance(low, high), 70.0) << name;
    for (std::size_t i = 12; i <= 127; i += 12) {
      EXPECT_GT(lab(linear(map.table()[i]))[0], lab(linear(map.table()[i - 12]))[0]) << name;
      EXPECT_GT(lab(linear(map.table()[255 - i]))[0], lab(linear(map.table()[255 - i + 12]))[0]) << name;
    }
  }
}

TEST(ColourMaps, TheCyclicMapClosesWithAStepLikeAllOthers) {
  const ColourMap& map = colour_map("compass");
  EXPECT_LT(unevenness(map, 0, 255, 15), 1.3);
  const double closing = distance(lab(linear(map.table()[248])), lab(linear(map.table()[7])));  // 15 steps
  const double other = distance(lab(linear(map.table()[100])), lab(linear(map.table()[115])));
  EXPECT_NEAR(closing / other, 1.0, 0.15);
}

TEST(ColourMaps, ThoseOfOthersAreAsPublished) {
  for (const PublishedEntries& published : kPublished) {
    const ColourMap& map = colour_map(published.name);
    for (const auto& [entry, rgb] : published.entries) {
      const Colour wanted = colour_for(rgb);
      const Colour made = map.table()[entry];
      EXPECT_NEAR(made.red, wanted.red, 5) << published.name << " at " << entry;
      EXPECT_NEAR(made.green, wanted.green, 5) << published.name << " at " << entry;
      EXPECT_NEAR(made.blue, wanted.blue, 5) << published.name << " at " << entry;
    }
    EXPECT_EQ(map.table().front(), colour_for(published.entries.front().second)) << published.name;
    EXPECT_EQ(map.table().back(), colour_for(published.entries.back().second)) << published.name;
  }
}

TEST(Colour, IsWrittenAsTheWebWritesIt) {
  EXPECT_EQ(hex_text(colour_for(0x0a1fe0)), "#0a1fe0");
  EXPECT_EQ(colour_for(0x123456), (Colour{0x12, 0x34, 0x56}));
}

}  // namespace
}  // namespace gdtslam
