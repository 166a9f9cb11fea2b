#include <utility>

#include "colour_path.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kColours = 256;
/// Of what has no value: neither in the way of a map's colours nor of a dark or light page.
constexpr Colour kUnknown = colour_for(0x8a8f98);
/// The same where the map itself is grey.
constexpr Colour kUnknownInGrey = colour_for(0x4d6fa8);

/// From both ends to the same light middle.
std::vector<Colour> diverging(double end_lightness, double middle_lightness, const std::vector<Hue>& low,
                              const std::vector<Hue>& high) {
  std::vector<Colour> table = even_path(end_lightness, middle_lightness, low, kColours / 2);
  const std::vector<Colour> other = even_path(end_lightness, middle_lightness, high, kColours / 2);
  table.insert(table.end(), other.rbegin(), other.rend());
  return table;
}

std::vector<ColourMap> made_maps() {
  std::vector<ColourMap> maps;
  maps.emplace_back("lagoon", "sequential: night blue, teal, green, yellow",
                    even_path(24.0, 95.0, {{28, -44}, {10, -37}, {-12, -23}, {-30, 4}, {-34, 40}, {-10, 62}}, kColours),
                    kUnknown);
  maps.emplace_back("ember", "sequential, warm: black, purple, red, orange, pale yellow",
                    even_path(6.0, 94.0, {{8, -16}, {32, -28}, {52, 2}, {46, 40}, {20, 48}, {-1, 32}}, kColours),
                    kUnknown);
  maps.emplace_back("tide", "sequential, for light pages: pale sand, green, blue, night blue",
                    even_path(93.0, 20.0, {{-2, 20}, {-22, 10}, {-16, -14}, {2, -34}, {14, -32}}, kColours), kUnknown);
  maps.emplace_back("grey", "sequential: black to white", even_path(0.0, 100.0, {{0, 0}, {0, 0}}, kColours),
                    kUnknownInGrey);
  maps.emplace_back("glow", "sequential: black, blue, warm white; a distance field's intensity, bright at obstacles",
                    even_path(4.0, 98.0, {{2, -8}, {2, -26}, {-4, -14}, {0, 12}, {0, 6}}, kColours), kUnknownInGrey);
  maps.emplace_back("blue-red", "diverging: blue below, light at the middle, red above",
                    diverging(37.0, 95.0, {{7, -47}, {0, -27}, {0, 0}}, {{42, 26}, {25, 16}, {0, 0}}), kUnknown);
  maps.emplace_back("green-purple", "diverging: green below, light at the middle, purple above",
                    diverging(37.0, 95.0, {{-36, 26}, {-24, 16}, {0, 0}}, {{33, -30}, {20, -18}, {0, 0}}), kUnknown);
  maps.emplace_back("compass", "cyclic, for directions: yellow, green, blue, red and yellow again",
                    even_circle(62.0, 17.0, 28.0, kColours), kUnknown);
  return maps;
}

}  // namespace

const std::vector<ColourMap>& colour_maps() {
  static const std::vector<ColourMap> maps = made_maps();
  return maps;
}

}  // namespace gdtslam
