// CIELAB (CIE 1976, white D65) and sRGB (IEC 61966-2-1). Thread-safe, constant time, the same bits on every host.
#pragma once

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

struct Lab {
  double lightness = 0.0;  ///< 0 black to 100 white
  double green_red = 0.0;
  double blue_yellow = 0.0;
};

/// Rounded to 8 bits; what sRGB cannot show is clamped.
Colour colour_for(const Lab& lab);
Lab lab_of(Colour colour);

}  // namespace gdtslam
