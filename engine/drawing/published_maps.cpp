#include "published_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::size_t kApart = 15;  ///< entries of the published tables from one of these to the next
constexpr std::size_t kKnots = 18;
constexpr std::size_t kEntries = kApart * (kKnots - 1) + 1;
static_assert(kEntries == 256);

struct PublishedMap {
  std::string_view name;
  std::string_view doc;
  std::array<std::uint32_t, kKnots> knots;
};
constexpr std::array<PublishedMap, 5> kPublished{
    {{"viridis",
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

double channel(std::uint32_t rgb, int shift) {
  return static_cast<double>(rgb >> static_cast<unsigned>(shift) & 0xFFU);
}

/// Between the second and the third of four values, a curve without a kink (Catmull and Rom's).
double curve(const std::array<double, 4>& four, double share) {
  const double squared = share * share;
  const double cubed = squared * share;
  return 0.5 * ((-cubed + 2.0 * squared - share) * four[0] + (3.0 * cubed - 5.0 * squared + 2.0) * four[1] +
                (-3.0 * cubed + 4.0 * squared + share) * four[2] + (cubed - squared) * four[3]);
}

std::uint8_t entry_channel(const std::array<std::uint32_t, kKnots>& knots, std::size_t entry, int shift) {
  const std::size_t leg = std::min(entry / kApart, kKnots - 2);
  const double from = channel(knots.at(leg), shift);
  const double to = channel(knots.at(leg + 1), shift);
  const double before = leg > 0 ? channel(knots.at(leg - 1), shift) : 2.0 * from - to;
  const double after = leg + 2 < kKnots ? channel(knots.at(leg + 2), shift) : 2.0 * to - from;
  const double share = static_cast<double>(entry - leg * kApart) / static_cast<double>(kApart);
  return static_cast<std::uint8_t>(std::floor(std::clamp(curve({before, from, to, after}, share), 0.0, 255.0) + 0.5));
}

}  // namespace

std::vector<ColourMap> published_colour_maps(Colour unknown) {
  std::vector<ColourMap> maps;
  for (const PublishedMap& map : kPublished) {
    std::vector<Colour> table;
    for (std::size_t entry = 0; entry < kEntries; ++entry) {
      table.push_back({entry_channel(map.knots, entry, 16), entry_channel(map.knots, entry, 8),
                       entry_channel(map.knots, entry, 0)});
    }
    maps.emplace_back(map.name, map.doc, std::move(table), unknown);
  }
  return maps;
}

}  // namespace gdtslam
