// The colour maps, ways through CIELAB along which equal steps look equally large; the same bits on every host.
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

/// CIELAB (CIE 1976, white D65).
struct Lab {
  double lightness = 0.0;  ///< 0 black to 100 white
  double green_red = 0.0;
  double blue_yellow = 0.0;
};

constexpr double kWhiteX = 0.95047;
constexpr double kWhiteZ = 1.08883;
/// Of the straight line that the cube root of CIELAB is near black.
constexpr double kSlope = 841.0 / 108.0;

double cube(double value) { return value > 6.0 / 29.0 ? value * value * value : (value - 4.0 / 29.0) / kSlope; }

std::uint8_t byte_of(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  const double encoded = clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * exp(1.0 / 2.4 * log(clamped)) - 0.055;
  return static_cast<std::uint8_t>(std::floor(encoded * 255.0 + 0.5));
}

/// Rounded to 8 bits; what sRGB (IEC 61966-2-1) cannot show is clamped.
Colour nearest_colour(const Lab& lab) {
  const double middle = (lab.lightness + 16.0) / 116.0;
  const double x = kWhiteX * cube(middle + lab.green_red / 500.0);
  const double y = cube(middle);
  const double z = kWhiteZ * cube(middle - lab.blue_yellow / 200.0);
  return {byte_of(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          byte_of(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          byte_of(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

/// A place in CIELAB's plane of hues.
struct Hue {
  double green_red = 0.0;
  double blue_yellow = 0.0;
};

constexpr int kStepsPerLeg = 64;

Hue operator*(double factor, const Hue& hue) { return {factor * hue.green_red, factor * hue.blue_yellow}; }
Hue operator+(const Hue& one, const Hue& other) {
  return {one.green_red + other.green_red, one.blue_yellow + other.blue_yellow};
}

double distance(const Hue& one, const Hue& other) {
  const double across = one.green_red - other.green_red;
  const double along = one.blue_yellow - other.blue_yellow;
  return std::sqrt(across * across + along * along);
}

/// Between the second and the third of four places, a curve without a kink (Catmull and Rom's).
Hue curve(const Hue* four, double share) {
  const double squared = share * share;
  const double cubed = squared * share;
  return 0.5 * (-cubed + 2.0 * squared - share) * four[0] + 0.5 * (3.0 * cubed - 5.0 * squared + 2.0) * four[1] +
         0.5 * (-3.0 * cubed + 4.0 * squared + share) * four[2] + 0.5 * (cubed - squared) * four[3];
}

/// Where a curve leads through places, in small steps.
std::vector<Hue> way_through(const std::vector<Hue>& places) {
  std::vector<Hue> ends{2.0 * places.front() + -1.0 * places[1]};
  ends.insert(ends.end(), places.begin(), places.end());
  ends.push_back(2.0 * places.back() + -1.0 * places[places.size() - 2]);
  std::vector<Hue> way;
  for (std::size_t leg = 0; leg + 1 < places.size(); ++leg) {
    for (int step = 0; step < kStepsPerLeg; ++step) {
      way.push_back(curve(&ends[leg], static_cast<double>(step) / kStepsPerLeg));
    }
  }
  way.push_back(places.back());
  return way;
}

/// `count` places along the way, the same distance between each two.
std::vector<Hue> even_places(const std::vector<Hue>& way, std::size_t count) {
  std::vector<double> walked{0.0};
  for (std::size_t i = 1; i < way.size(); ++i) walked.push_back(walked.back() + distance(way[i - 1], way[i]));
  std::vector<Hue> places;
  std::size_t at = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double goal = walked.back() * static_cast<double>(i) / static_cast<double>(count - 1);
    while (at + 1 < way.size() && walked[at] < goal) ++at;
    const double step = walked[at] - walked[at - 1];
    const double share = step > 0.0 ? std::clamp((goal - walked[at - 1]) / step, 0.0, 1.0) : 0.0;
    places.push_back((1.0 - share) * way[at - 1] + share * way[at]);
  }
  return places;
}

/// From one lightness to another through at least two hues: lightness changes evenly and so does the place among the
/// hues, so that every step is equally far in CIELAB.
std::vector<Colour> even_path(double from_lightness, double to_lightness, const std::vector<Hue>& places,
                              std::size_t count) {
  const std::vector<Hue> hues = even_places(way_through(places), count);
  std::vector<Colour> table;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    table.push_back(nearest_colour(
        Lab{from_lightness + share * (to_lightness - from_lightness), hues[i].green_red, hues[i].blue_yellow}));
  }
  return table;
}

constexpr std::size_t kColours = 256;
/// Of what has no value: neither in the way of a map's colours nor of a dark or light page.
constexpr Colour kUnknown = colour_for(0x8a8f98);
/// The same where the map itself is grey.
constexpr Colour kUnknownInGrey = colour_for(0x4d6fa8);

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
  maps.emplace_back("glow", "sequential: black, blue, warm white; a distance field's intensity, bright at obstacles",
                    even_path(4.0, 98.0, {{2, -8}, {2, -26}, {-4, -14}, {0, 12}, {0, 6}}, kColours), kUnknownInGrey);
  return maps;
}

}  // namespace

const std::vector<ColourMap>& colour_maps() {
  static const std::vector<ColourMap> maps = made_maps();
  return maps;
}

}  // namespace gdtslam
