// Colours: the palette of all pictures of gdtslam, and the colour maps from numbers to colours. The maps are our own:
// paths through CIELAB with evenly changing lightness, so that equal steps of the number look equal. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// Red, green and blue of sRGB, eight bits each.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};
/// From 0xRRGGBB.
constexpr Colour colour_for(std::uint32_t rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16U), static_cast<std::uint8_t>(rgb >> 8U & 0xFFU),
          static_cast<std::uint8_t>(rgb & 0xFFU)};
}
/// "#rrggbb".
std::string hex_text(Colour colour);

/// Colours legible on white and on kCard; a line in one of the bars' colours also has the bar's name.
namespace ink {
inline constexpr Colour kPage = colour_for(0xf6f5f1);
inline constexpr Colour kCard = colour_for(0xffffff);
inline constexpr Colour kEdge = colour_for(0xdedbd2);
inline constexpr Colour kText = colour_for(0x22262b);
inline constexpr Colour kQuiet = colour_for(0x68707a);
inline constexpr Colour kGrid = colour_for(0xe9e7e1);
inline constexpr Colour kCrank = colour_for(0xc8471d);
inline constexpr Colour kCoupler = colour_for(0x0069a8);
inline constexpr Colour kRocker = colour_for(0x00795a);
inline constexpr Colour kGround = colour_for(0x4a4f57);
inline constexpr Colour kCurve = colour_for(0xa2559c);
inline constexpr Colour kLaser = colour_for(0xd98b00);
inline constexpr Colour kLaserText = colour_for(0x8a5800);
inline constexpr Colour kWarning = colour_for(0xb3261e);
inline constexpr Colour kNight = colour_for(0x14171c);  ///< background of 3D scenes
}  // namespace ink

/// 256 colours from the least to the largest value.
class ColourMap {
 public:
  /// Name and doc must have static storage; `unknown` is the colour of NaN.
  ColourMap(std::string_view name, std::string_view doc, std::vector<Colour> table, Colour unknown);
  /// `share` 0 to 1, clamped; not a number gives `unknown`.
  [[nodiscard]] Colour at(double share) const;
  [[nodiscard]] const std::vector<Colour>& table() const { return table_; }
  [[nodiscard]] Colour unknown() const { return unknown_; }
  [[nodiscard]] std::string_view name() const { return name_; }
  [[nodiscard]] std::string_view doc() const { return doc_; }

 private:
  std::string_view name_;
  std::string_view doc_;
  std::vector<Colour> table_;
  Colour unknown_;
};
/// All maps; the first is the default for heights.
const std::vector<ColourMap>& colour_maps();
/// Throws ConfigError with the known names.
const ColourMap& colour_map(std::string_view name);

/// The colours of a page.
struct Theme {
  Colour page;
  Colour card;  ///< under a plot or a legend
  Colour edge;  ///< around a card
  Colour text;
  Colour quiet;  ///< explanatory words
  Colour grid;
  Colour warning;
  std::array<Colour, 6> series;  ///< curves, in this order; distinct for people with any colour vision
  [[nodiscard]] Colour curve(std::size_t number) const { return series[number % series.size()]; }
};

inline constexpr Theme kLightTheme{
    ink::kPage,    ink::kCard,
    ink::kEdge,    ink::kText,
    ink::kQuiet,   ink::kGrid,
    ink::kWarning, {ink::kCoupler, ink::kCrank, ink::kRocker, ink::kCurve, ink::kLaser, ink::kGround}};
inline constexpr Theme kDarkTheme{ink::kNight,
                                  colour_for(0x1d2128),
                                  colour_for(0x363c46),
                                  colour_for(0xe9e7e1),
                                  colour_for(0xa3abb6),
                                  colour_for(0x2c313a),
                                  colour_for(0xff8f86),
                                  {colour_for(0x62b4f0), colour_for(0xff8b5c), colour_for(0x4fcb9d),
                                   colour_for(0xdb9dd6), colour_for(0xffc455), colour_for(0xb2bac5)}};

}  // namespace gdtslam
