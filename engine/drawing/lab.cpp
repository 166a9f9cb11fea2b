#include "lab.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr double kWhiteX = 0.95047;
constexpr double kWhiteZ = 1.08883;
/// Below it the cube root of CIELAB is a straight line: (6/29)^3.
constexpr double kKnee = 216.0 / 24389.0;
constexpr double kSlope = 841.0 / 108.0;

double power(double base, double exponent) { return exp(exponent * log(base)); }

double root(double share) { return share > kKnee ? power(share, 1.0 / 3.0) : kSlope * share + 4.0 / 29.0; }

double cube(double value) { return value > 6.0 / 29.0 ? value * value * value : (value - 4.0 / 29.0) / kSlope; }

std::uint8_t byte_of(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  const double encoded = clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * power(clamped, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::floor(encoded * 255.0 + 0.5));
}

double linear_of(std::uint8_t byte) {
  const double encoded = byte / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : power((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

Colour colour_for(const Lab& lab) {
  const double middle = (lab.lightness + 16.0) / 116.0;
  const double x = kWhiteX * cube(middle + lab.green_red / 500.0);
  const double y = cube(middle);
  const double z = kWhiteZ * cube(middle - lab.blue_yellow / 200.0);
  return {byte_of(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          byte_of(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          byte_of(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

Lab lab_of(Colour colour) {
  const double red = linear_of(colour.red);
  const double green = linear_of(colour.green);
  const double blue = linear_of(colour.blue);
  const double x = root((0.4124564 * red + 0.3575761 * green + 0.1804375 * blue) / kWhiteX);
  const double y = root(0.2126729 * red + 0.7151522 * green + 0.0721750 * blue);
  const double z = root((0.0193339 * red + 0.1191920 * green + 0.9503041 * blue) / kWhiteZ);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

}  // namespace gdtslam
