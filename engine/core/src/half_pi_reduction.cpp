#include "half_pi_reduction.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "elementary_tables.hpp"

namespace gdtslam::elementary {
namespace {

// Cody and Waite [Cody1980]: n pi/2 is taken away piece by piece, the products with the pieces are exact.
ReducedAngle reduce_small(double angle_rad) {
  constexpr double kTwoOverPiRounded = 0x1.45f306dc9c883p-1;
  constexpr double kShift = 0x1.8p52;
  const double shifted = angle_rad * kTwoOverPiRounded + kShift;
  const double n = shifted - kShift;
  const auto quadrant = std::bit_cast<std::uint64_t>(shifted) & 3U;
  const double first = angle_rad - n * kHalfPiParts[0];
  const double second_part = n * kHalfPiParts[1];
  double high = first - second_part;
  double low = (first - high) - second_part;
  if (std::fabs(high) > 0x1p-10) {
    low -= n * kHalfPiParts[2];
    return {high, low, quadrant};
  }
  // Close to a multiple of pi/2 the third and the fourth piece count, too, and each difference keeps what it rounds
  // off.
  const double third_part = n * kHalfPiParts[2];
  const double sum = high - third_part;
  const double part = sum - high;
  low += (high - (sum - part)) - (third_part + part);
  low -= n * kHalfPiParts[3];
  high = sum + low;
  low = (sum - high) + low;
  return {high, low, quadrant};
}

// 64 x 64 bits to the upper and lower 64 of the product.
struct Wide {
  std::uint64_t high;
  std::uint64_t low;
};

Wide multiply(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t a_low = a & 0xFFFFFFFFU;
  const std::uint64_t a_high = a >> 32U;
  const std::uint64_t b_low = b & 0xFFFFFFFFU;
  const std::uint64_t b_high = b >> 32U;
  const std::uint64_t low = a_low * b_low;
  const std::uint64_t middle = a_high * b_low + (low >> 32U);
  const std::uint64_t other = a_low * b_high + (middle & 0xFFFFFFFFU);
  return {a_high * b_high + (middle >> 32U) + (other >> 32U), (other << 32U) | (low & 0xFFFFFFFFU)};
}

// 64 bits of 2/pi that start `position` bits behind the point; bits before the point are 0.
std::uint64_t two_over_pi_bits(std::int64_t position) {
  const auto word_at = [](std::int64_t index) {
    return index < 0 || index >= static_cast<std::int64_t>(kTwoOverPi.size())
               ? std::uint64_t{0}
               : kTwoOverPi[static_cast<std::size_t>(index)];
  };
  const std::int64_t index = position >= 0 ? position / 64 : -((63 - position) / 64);
  const auto shift = static_cast<std::uint64_t>(position - 64 * index);
  const std::uint64_t first = word_at(index) << shift;
  return shift == 0 ? first : first | (word_at(index + 1) >> (64U - shift));
}

// Payne and Hanek [Payne1983]: only the bits of 2/pi count that meet the mantissa between 4 turns and the last bit
// wanted.
ReducedAngle reduce_large(double angle_rad) {
  const std::uint64_t pattern = std::bit_cast<std::uint64_t>(angle_rad);
  const std::uint64_t mantissa = (pattern & 0x000FFFFFFFFFFFFFU) | 0x0010000000000000U;
  const auto exponent = static_cast<std::int64_t>((pattern >> 52U) & 0x7FFU) - 1075;
  // |angle| 2/pi = mantissa 2^exponent (2/pi). Bits of 2/pi above 2^(2 - exponent) give multiples of 4 quarter turns.
  const std::int64_t start = exponent - 2;
  std::array<std::uint64_t, 4> bits{};
  for (std::size_t i = 0; i < bits.size(); ++i) {
    bits[i] = two_over_pi_bits(start + 64 * static_cast<std::int64_t>(i));
  }
  // mantissa * bits, of which 256 bits behind the 2^2 place are kept; the highest word drops its multiples of 4.
  std::array<std::uint64_t, 4> product{};
  std::uint64_t carry = 0;
  for (std::size_t i = bits.size(); i-- > 0;) {
    const Wide wide = multiply(mantissa, bits[i]);
    product[i] = wide.low + carry;
    carry = wide.high + (product[i] < carry ? 1U : 0U);
  }
  // product = (quarter turns mod 4) * 2^62 in its first word, the fraction below.
  std::uint64_t quadrant = product[0] >> 62U;
  for (std::size_t i = 0; i < 3; ++i) {
    product[i] = (product[i] << 2U) | (product[i + 1] >> 62U);
  }
  // The fraction in [-1/2, 1/2): above one half, the next quarter turn is nearer.
  const bool is_negative = (product[0] >> 63U) != 0;
  if (is_negative) {
    ++quadrant;
    for (std::size_t i = 0; i < 3; ++i) {
      product[i] = ~product[i];
    }
  }
  std::int64_t scale = 0;
  while (product[0] >> 63U == 0 && scale < 128) {
    product[0] = (product[0] << 1U) | (product[1] >> 63U);
    product[1] = (product[1] << 1U) | (product[2] >> 63U);
    product[2] <<= 1U;
    ++scale;
  }
  // 106 leading bits of the fraction in two doubles, times pi/2 in two doubles.
  const double unit = std::bit_cast<double>(static_cast<std::uint64_t>(1023 - 53 - scale) << 52U);
  const double f_high = static_cast<double>(product[0] >> 11U) * unit;
  const double f_low = static_cast<double>(((product[0] & 0x7FFU) << 42U) | (product[1] >> 22U)) * (unit * 0x1p-53);
  constexpr double kHalfPiHigh = 0x1.921fb54442d18p+0;
  constexpr double kHalfPiLow = 0x1.1a62633145c07p-54;
  constexpr double kHalfPiHead = 0x1.921fb54p+0;
  constexpr double kHalfPiTail = kHalfPiHigh - kHalfPiHead;
  const double f_big = (0x1p27 + 1.0) * f_high;
  const double f_head = f_big - (f_big - f_high);
  const double f_tail = f_high - f_head;
  const double main = f_high * kHalfPiHigh;
  const double lost =
      ((f_head * kHalfPiHead - main) + f_head * kHalfPiTail + f_tail * kHalfPiHead) + f_tail * kHalfPiTail;
  const double rest = lost + (f_high * kHalfPiLow + f_low * kHalfPiHigh);
  const double high = main + rest;
  const double low = (main - high) + rest;
  const bool is_flipped = is_negative != std::signbit(angle_rad);
  const std::uint64_t turns = std::signbit(angle_rad) ? 0U - quadrant : quadrant;
  return {is_flipped ? -high : high, is_flipped ? -low : low, turns & 3U};
}

}  // namespace

ReducedAngle reduce_by_half_pi(double angle_rad) {
  constexpr double kLargest = 2e5;
  return std::fabs(angle_rad) <= kLargest ? reduce_small(angle_rad) : reduce_large(angle_rad);
}

}  // namespace gdtslam::elementary
