// Quantities as text with their unit: "5 cm", "0.05 m", "2 deg", "250 ms", "3 cells", "30 %". Values are SI inside the
// program; a bare number is in the unit's own base (metre, radian, second, cell, share). Independent of the locale.
// Thread-safe, linear in the text's length.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gdtslam {

/// The kind of quantity that a number measures.
enum class Unit { kNone, kMetre, kRadian, kSecond, kCell, kShare };

/// The symbol of the base unit: "m", "rad", "s", "cells"; empty for a pure number and a share.
std::string_view unit_symbol(Unit unit);

/// The finite value of the text in the base unit: the double nearest to the decimal number (for degrees, minutes and
/// hours within 1 ulp). Allows blanks around the parts. Returns none, with the reason in *why (may be null), if the
/// text is no number, its unit is unknown or of another kind, or the value is beyond the range of double.
std::optional<double> parse_quantity(std::string_view text, Unit unit, std::string* why);

/// The shortest text that parse_quantity reads back as the same bits, with the base unit's symbol: "0.05 m"; angles in
/// degrees if that is shorter: "10 deg".
std::string format_quantity(double value, Unit unit);

/// parse_quantity() for a command line: a bare number other than 0 is refused if the unit is metre, radian or second,
/// because the unit of a typed 90 or 5 is ambiguous. Counts, cells and shares have one unit and stay numbers.
std::optional<double> parse_stated_quantity(std::string_view text, Unit unit, std::string* why);

/// Text for people, not for reading back: an angle in degrees to six digits; else like format_quantity(), but never
/// "1e+05".
std::string show_quantity(double value, Unit unit);

}  // namespace gdtslam
