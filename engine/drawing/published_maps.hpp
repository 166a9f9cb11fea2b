// Colour maps that others designed and readers know by name. Thread-safe once made.
#pragma once

#include <vector>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {

/// viridis, magma, inferno and plasma [Smith2015] and turbo [Mikhailov2019]: every fifteenth colour as published,
/// curves between them; no channel is more than 5 of 255 off.
std::vector<ColourMap> published_colour_maps(Colour unknown);

}  // namespace gdtslam
