#include "four_bar_text.hpp"

#include <array>
#include <charconv>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

std::string as_text(double value, std::chars_format format, int digits) {
  std::array<char, 400> buffer{};  // a double in fixed notation has 309 digits before its point
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, digits);
  return std::string(buffer.data(), end.ptr);
}

}  // namespace

std::string number_text(double value, int digits) { return as_text(value, std::chars_format::general, digits); }

std::string cm_text(double length_m) { return number_text(100.0 * length_m); }

std::string angle_text(double angle_rad) {
  return as_text(deg_from_rad(angle_rad), std::chars_format::fixed, 1) + " deg";
}

}  // namespace gdtslam::calib
