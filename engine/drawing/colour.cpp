// Colours as text, and the colour maps: every fifteenth colour of a table, with curves in between. They are paths
// through CIELAB on which equal steps look equal. The same bits on every host.
#include "gdtslam/drawing/colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kKnots = 18;
constexpr std::size_t kEntries = 256;
/// Colour of cells and points without a value, distinct from a map's colours and from a dark or light page.
constexpr Colour kUnknown = colour_for(0x8a8f98);
/// The same for a grey map.
constexpr Colour kUnknownInGrey = colour_for(0x4d6fa8);

struct KnottedMap {
  std::string_view name;
  std::string_view doc;
  std::array<std::uint32_t, kKnots> knots;
};
constexpr std::array<KnottedMap, 4> kMaps{
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
     {"glow",
      "sequential: black, blue, warm white; a distance field's intensity, bright at obstacles",
      {0x0b0d1a, 0x131a2a, 0x19263c, 0x20324e, 0x263f62, 0x2b4c72, 0x3a5a7b, 0x4a6883, 0x5b768b, 0x6e8393, 0x81919b,
       0x949fa3, 0xa8adab, 0xbcbcb3, 0xcfcabb, 0xe3d9c3, 0xf2e9d7, 0xfef9ee}}}};

/// Smooth interpolation between the second and the third of four values (Catmull-Rom).
double curve(const std::array<double, 4>& four, double share) {
  const double squared = share * share;
  const double cubed = squared * share;
  return 0.5 * ((-cubed + 2.0 * squared - share) * four[0] + (3.0 * cubed - 5.0 * squared + 2.0) * four[1] +
                (-3.0 * cubed + 4.0 * squared + share) * four[2] + (cubed - squared) * four[3]);
}

/// One channel, `shift` bits up, at a position between the knots.
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
  add_entries(table, knots, kEntries);
  const bool is_grey = map.name == "glow";
  return {map.name, map.doc, std::move(table), is_grey ? kUnknownInGrey : kUnknown};
}

}  // namespace

std::string hex_text(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

ColourMap::ColourMap(std::string_view name, std::string_view doc, std::vector<Colour> table, Colour unknown)
    : name_(name), doc_(doc), table_(std::move(table)), unknown_(unknown) {}

Colour ColourMap::at(double share) const {
  if (std::isnan(share)) return unknown_;
  return table_[static_cast<std::size_t>(
      std::floor(std::clamp(share, 0.0, 1.0) * static_cast<double>(table_.size() - 1) + 0.5))];
}

const ColourMap& colour_map(std::string_view name) {
  std::string names;
  for (const ColourMap& map : colour_maps()) {
    if (map.name() == name) return map;
    names += (names.empty() ? "" : ", ") + std::string(map.name());
  }
  throw ConfigError(fmt::format("there is no colour map '{}': there are {}", name, names));
}

const std::vector<ColourMap>& colour_maps() {
  static const std::vector<ColourMap> maps = [] {
    std::vector<ColourMap> made;
    made.reserve(std::size(kMaps));
    for (const KnottedMap& map : kMaps) made.push_back(made_map(map));
    return made;
  }();
  return maps;
}

}  // namespace gdtslam
