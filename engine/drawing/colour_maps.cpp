// The colour maps: every fifteenth colour of a table, curves between them. Ours are paths through CIELAB along which
// equal steps look equally large; those of others are viridis, magma, inferno and plasma [Smith2015] and turbo
// [Mikhailov2019], no channel more than 5 of 255 off. The same bits on every host.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kKnots = 18;
constexpr std::size_t kEntries = 256;
/// Of what has no value: neither in the way of a map's colours nor of a dark or light page.
constexpr Colour kUnknown = colour_for(0x8a8f98);
/// The same where the map itself is grey.
constexpr Colour kUnknownInGrey = colour_for(0x4d6fa8);

struct KnottedMap {
  std::string_view name;
  std::string_view doc;
  std::array<std::uint32_t, kKnots> knots;
};
constexpr std::array<KnottedMap, 13> kMaps{
    {{"lagoon",
      "sequential: night blue, teal, green, yellow",
      {0x362d7c, 0x343b82, 0x314988, 0x2e578c, 0x2b6490, 0x2b7192, 0x327e92, 0x3b8a92, 0x469790, 0x53a38d, 0x63af88,
       0x73bb84, 0x84c67e, 0x98d178, 0xb1db74, 0xcce373, 0xe8eb74, 0xfff375}},
     {"ember",
      "sequential, warm: black, purple, red, orange, pale yellow",
      {0x121028, 0x23173b, 0x351d4f, 0x4d205d, 0x682261, 0x822763, 0x992d62, 0xaf3661, 0xc2435f, 0xd4515c, 0xe36158,
       0xf17355, 0xf98756, 0xfd9c5d, 0xffb169, 0xffc67d, 0xffd996, 0xffecb0}},
     {"tide",
      "sequential, for light pages: pale sand, green, blue, night blue",
      {0xf7ebc5, 0xe0e1bc, 0xc9d8b3, 0xb1cfab, 0x9ac5a4, 0x86bba2, 0x75afa0, 0x67a39d, 0x5a979a, 0x4d8b97, 0x407f94,
       0x35738f, 0x2a688b, 0x1f5c86, 0x145080, 0x0f4479, 0x1b386d, 0x232c60}},
     {"grey",
      "sequential: black to white",
      {0x000000, 0x131313, 0x1f1f1f, 0x2b2b2b, 0x383838, 0x454545, 0x535353, 0x616161, 0x707070, 0x7e7e7e, 0x8d8d8d,
       0x9d9d9d, 0xadadad, 0xbdbdbd, 0xcdcdcd, 0xdddddd, 0xeeeeee, 0xffffff}},
     {"glow",
      "sequential: black, blue, warm white; a distance field's intensity, bright at obstacles",
      {0x0b0d1a, 0x131a2a, 0x19263c, 0x20324e, 0x263f62, 0x2b4c72, 0x3a5a7b, 0x4a6883, 0x5b768b, 0x6e8393, 0x81919b,
       0x949fa3, 0xa8adab, 0xbcbcb3, 0xcfcabb, 0xe3d9c3, 0xf2e9d7, 0xfef9ee}},
     {"blue-red",
      "diverging: blue below, light at the middle, red above",
      {0x0058a3, 0x326aad, 0x507db8, 0x6a90c2, 0x85a3cb, 0xa0b6d5, 0xbbc9de, 0xd6dde7, 0xf1f1f1, 0xf1f1f1, 0xe9d9d6,
       0xe0c1bc, 0xd7a9a2, 0xcc9289, 0xc17b72, 0xb5645b, 0xa84d45, 0x9a3430}},
     {"green-purple",
      "diverging: green below, light at the middle, purple above",
      {0x1a642b, 0x387542, 0x52865a, 0x6b9872, 0x85a98a, 0xa0bba3, 0xbacdbc, 0xd5ded6, 0xf1f1f1, 0xf1f1f1, 0xe1dae3,
       0xd1c3d6, 0xc2adc8, 0xb297bb, 0xa382ae, 0x936da1, 0x835895, 0x734488}},
     {"compass",
      "cyclic, for directions: yellow, green, blue, red and yellow again",
      {0xc58397, 0xd89395, 0xe4a493, 0xe6b491, 0xdbc090, 0xc6c590, 0xa8c191, 0x87b892, 0x65ab94, 0x459c96, 0x298d97,
       0x1d7f98, 0x2f7399, 0x4e6c99, 0x6f6a99, 0x8e6d99, 0xab7698, 0xc48297}},
     {"viridis",
      "sequential, matplotlib's: purple, blue, green, yellow",
      {0x440154, 0x481769, 0x472a7a, 0x433d84, 0x3d4e8a, 0x355e8d, 0x2e6d8e, 0x297b8e, 0x23898e, 0x1f978b, 0x21a585,
       0x2eb37c, 0x46c06f, 0x65cb5e, 0x89d548, 0xb0dd2f, 0xd8e219, 0xfde725}},
     {"magma",
      "sequential, matplotlib's: black, purple, pink, pale yellow",
      {0x000004, 0x090720, 0x1a1042, 0x311165, 0x4a1079, 0x621980, 0x792282, 0x912b81, 0xaa337d, 0xc23b75, 0xd9466b,
       0xec5860, 0xf7725c, 0xfc8e64, 0xfeaa74, 0xfec68a, 0xfde2a3, 0xfcfdbf}},
     {"inferno",
      "sequential, matplotlib's: black, violet, red, orange, pale yellow",
      {0x000004, 0x0a0722, 0x1e0c45, 0x380962, 0x510e6c, 0x69166e, 0x801f6c, 0x982766, 0xb0315b, 0xc63d4d, 0xd94d3d,
       0xe9612b, 0xf47918, 0xfa9407, 0xfcb014, 0xf8cd37, 0xf2ea69, 0xfcffa4}},
     {"plasma",
      "sequential, matplotlib's: blue, purple, orange, yellow",
      {0x0d0887, 0x2f0596, 0x4903a0, 0x6100a7, 0x7801a8, 0x8e0ca4, 0xa21d9a, 0xb42e8d, 0xc43e7f, 0xd24f71, 0xde6164,
       0xe97257, 0xf3854b, 0xf99a3e, 0xfdaf31, 0xfdc627, 0xf8df25, 0xf0f921}},
     {"turbo",
      "rainbow, brightest at the middle: blue, green, yellow, red; differences stand out, order does not",
      {0x30123b, 0x3f3e9c, 0x4666dd, 0x458cfd, 0x2fb2f4, 0x1ad4d0, 0x22ebaa, 0x52fa7a, 0x8bff4b, 0xb7f735, 0xdbe236,
       0xf5c53a, 0xfea130, 0xf9751d, 0xe84b0c, 0xce2d04, 0xa91601, 0x7a0403}}}};

/// Between the second and the third of four values, a curve without a kink (Catmull and Rom's).
double curve(const std::array<double, 4>& four, double share) {
  const double squared = share * share;
  const double cubed = squared * share;
  return 0.5 * ((-cubed + 2.0 * squared - share) * four[0] + (3.0 * cubed - 5.0 * squared + 2.0) * four[1] +
                (-3.0 * cubed + 4.0 * squared + share) * four[2] + (cubed - squared) * four[3]);
}

/// One of the three channels, `shift` bits up, at a place between the knots.
std::uint8_t channel_at(std::span<const std::uint32_t> knots, double place, unsigned shift) {
  const auto channel = [&](std::size_t k) { return static_cast<double>(knots[k] >> shift & 0xFFU); };
  const std::size_t leg = std::min(static_cast<std::size_t>(place), knots.size() - 2);
  const double from = channel(leg);
  const double to = channel(leg + 1);
  const double before = leg > 0 ? channel(leg - 1) : 2.0 * from - to;
  const double after = leg + 2 < knots.size() ? channel(leg + 2) : 2.0 * to - from;
  const double value = curve({before, from, to, after}, place - static_cast<double>(leg));
  return static_cast<std::uint8_t>(std::floor(std::clamp(value, 0.0, 255.0) + 0.5));
}

void add_entries(std::vector<Colour>& table, std::span<const std::uint32_t> knots, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i * (knots.size() - 1)) / static_cast<double>(count - 1);
    table.push_back({channel_at(knots, place, 16), channel_at(knots, place, 8), channel_at(knots, place, 0)});
  }
}

ColourMap made_map(const KnottedMap& map) {
  const std::span<const std::uint32_t> knots(map.knots);
  std::vector<Colour> table;
  if (map.doc.starts_with("diverging")) {  // two halves, and a kink at the light middle
    add_entries(table, knots.first(kKnots / 2), kEntries / 2);
    add_entries(table, knots.last(kKnots / 2), kEntries / 2);
  } else {
    add_entries(table, knots, kEntries);
  }
  const bool is_grey = map.name == "grey" || map.name == "glow";
  return {map.name, map.doc, std::move(table), is_grey ? kUnknownInGrey : kUnknown};
}

}  // namespace

const std::vector<ColourMap>& colour_maps() {
  static const std::vector<ColourMap> maps = [] {
    std::vector<ColourMap> made;
    for (const KnottedMap& map : kMaps) made.push_back(made_map(map));
    return made;
  }();
  return maps;
}

}  // namespace gdtslam
