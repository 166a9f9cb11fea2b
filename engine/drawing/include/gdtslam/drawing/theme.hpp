// How drawings look: colours on light and on dark pages, a place on the page. Thread-safe.
#pragma once

#include <array>
#include <cstddef>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

/// A rectangle of the page, pixels.
struct DrawingArea {
  Point2 corner = Point2::Zero();  ///< upper left
  double width = 0.0;
  double height = 0.0;
};

/// The colours of a page.
struct Theme {
  Colour page;
  Colour card;  ///< under a plot or a legend
  Colour edge;  ///< of a card
  Colour text;
  Colour quiet;  ///< words that explain
  Colour grid;
  Colour warning;
  std::array<Colour, 6> series;  ///< of curves, told apart by people with any colour vision, in this order
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
