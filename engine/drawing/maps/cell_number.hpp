// What stands in a cell of a small distance transform. Constant time.
#pragma once

#include <cstdint>
#include <string>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam::picture {

struct CellNumber {
  bool is_known = false;     ///< below the cap
  bool is_obstacle = false;  ///< nearer than half a cell: 0 in an exact transform, about 0 where scans were merged
  double distance = 0.0;     ///< cells
  bool is_whole = true;      ///< within the field's 1/256 cell
  std::string text;          ///< without decimals where it is whole, else with one
  std::string text_tenths;   ///< with one decimal in any case, for a sheet where others need it
};
CellNumber cell_number(std::uint16_t value, std::uint16_t cap, bool is_squared);

/// Of black and white the one that stands out more from the ground, by the contrast ratio of WCAG 2.
Colour legible_on(Colour ground);
/// A channel of sRGB (IEC 61966-2-1) as light, 0 to 1.
double linear_of(std::uint8_t channel);
/// (L1 + 0.05) / (L2 + 0.05) of the relative luminances, 1 to 21.
double contrast_of(Colour a, Colour b);

}  // namespace gdtslam::picture
