// Quantities as people read them, where nothing reads them back: every angle in degrees, whole numbers in full.
// Thread-safe.
#pragma once

#include <string>

#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// An angle in degrees to six digits; else as format_quantity() (core/units.hpp), but never "1e+05".
std::string show_quantity(double value, Unit unit);

}  // namespace gdtslam
