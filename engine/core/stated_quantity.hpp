// Quantities as people type them on a command line. A length, an angle or a time has to state its unit there, because
// nobody who types 90 or 5 can be expected to know which unit is meant. Thread-safe, linear in the text's length.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// parse_quantity (core/units.hpp), but a bare number other than 0 is refused where the unit is metre, radian or
/// second. What has one unit only (counts, cells, shares) stays a number.
std::optional<double> parse_stated_quantity(std::string_view text, Unit unit, std::string* why);

}  // namespace gdtslam
