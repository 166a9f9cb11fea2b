// Lengths and angles in messages: in centimetres and degrees, for builders of linkages; the same text in every locale.
#pragma once

#include <string>

namespace gdtslam::calib {

/// At most `digits` significant digits, no trailing zeros: "16.1".
std::string number_text(double value, int digits = 6);
/// Centimetres without their unit.
std::string cm_text(double length_m);
/// "40.5 deg", one decimal.
std::string angle_text(double angle_rad);

}  // namespace gdtslam::calib
