#include "cell_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/elementary.hpp"

namespace gdtslam::picture {
namespace {

constexpr double kUnit = 1.0 / 256.0;  // cells
constexpr std::uint16_t kHalfCell = 128;

double luminance(Colour colour) {
  return 0.2126 * linear_of(colour.red) + 0.7152 * linear_of(colour.green) + 0.0722 * linear_of(colour.blue);
}

void write(CellNumber& number, double value, double tolerance) {
  const double whole = std::floor(value + 0.5);
  number.is_whole = std::fabs(value - whole) <= tolerance;
  number.text_tenths = fmt::format("{:.1f}", number.is_whole ? whole : value);
  number.text = number.is_whole ? fmt::format("{:.0f}", whole) : number.text_tenths;
}

}  // namespace

CellNumber cell_number(std::uint16_t value, std::uint16_t cap, bool is_squared) {
  CellNumber number;
  number.is_known = value < cap;
  number.is_obstacle = number.is_known && value < kHalfCell;
  number.distance = value * kUnit;
  if (!number.is_known) {
    number.text = number.text_tenths = "–";
  } else if (is_squared) {
    // The field holds the root, rounded to its unit: the square is off by up to the distance times that unit.
    write(number, number.distance * number.distance, number.distance * kUnit + 0.25 * kUnit * kUnit);
  } else {
    write(number, number.distance, 0.0);
  }
  return number;
}

double linear_of(std::uint8_t channel) {
  const double value = channel / 255.0;
  return value <= 0.04045 ? value / 12.92 : gdtslam::exp(2.4 * gdtslam::log((value + 0.055) / 1.055));
}

double contrast_of(Colour a, Colour b) {
  constexpr double kFlare = 0.05;
  double light = luminance(a);
  double dark = luminance(b);
  if (light < dark) std::swap(light, dark);
  return (light + kFlare) / (dark + kFlare);
}

Colour legible_on(Colour ground) {
  constexpr Colour kBlack{0, 0, 0};
  constexpr Colour kWhite{255, 255, 255};
  return contrast_of(ground, kBlack) >= contrast_of(ground, kWhite) ? kBlack : kWhite;
}

}  // namespace gdtslam::picture
