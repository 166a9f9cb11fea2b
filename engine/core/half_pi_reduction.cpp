#include "half_pi_reduction.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "double_double.hpp"
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
  const double high = first - second_part;
  const double excess = second_part - (first - high);
  if (std::fabs(high) > 0x1p-10 || n == 0.0) {
    return {high, excess + n * kHalfPiParts[2], quadrant};
  }
  // Close to a multiple of pi/2 the third and the fourth piece count, too, and each difference keeps what it rounds
  // off.
  const HighLow closer = two_sum(high, -n * kHalfPiParts[2]);
  const double rest = (closer.low - excess) - n * kHalfPiParts[3];
  const double sum = closer.high + rest;
  return {sum, (sum - closer.high) - rest, quadrant};
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

// |angle| 2/pi modulo 4: whole quarter turns, and the fraction as 192 bits behind the point.
struct QuarterTurns {
  std::uint64_t whole = 0;
  std::array<std::uint64_t, 3> fraction{};
};

// Payne and Hanek [Payne1983]: of 2/pi only the bits count that meet the mantissa between 4 quarter turns and the last
// bit wanted.
QuarterTurns quarter_turns(double angle_rad) {
  const std::uint64_t pattern = std::bit_cast<std::uint64_t>(angle_rad);
  const std::uint64_t mantissa = (pattern & 0x000FFFFFFFFFFFFFU) | 0x0010000000000000U;
  const auto exponent = static_cast<std::int64_t>((pattern >> 52U) & 0x7FFU) - 1075;
  // |angle| = mantissa 2^exponent, so the bits of 2/pi before this one give multiples of 4 quarter turns.
  const std::int64_t start = exponent - 2;
  std::array<std::uint64_t, 4> product{};
  std::uint64_t carry = 0;
  for (std::size_t i = product.size(); i-- > 0;) {
    const Wide wide = multiply(mantissa, two_over_pi_bits(start + 64 * static_cast<std::int64_t>(i)));
    product[i] = wide.low + carry;
    carry = wide.high + (product[i] < carry ? 1U : 0U);
  }
  QuarterTurns turns{product[0] >> 62U, {}};
  for (std::size_t i = 0; i < turns.fraction.size(); ++i) {
    turns.fraction[i] = (product[i] << 2U) | (product[i + 1] >> 62U);
  }
  return turns;
}

// The fraction, a half or less, times pi/2; its 106 leading bits count.
ReducedAngle angle_of_fraction(std::array<std::uint64_t, 3> fraction) {
  std::uint64_t scale = 0;
  while (fraction[0] >> 63U == 0 && scale < 128) {
    fraction[0] = (fraction[0] << 1U) | (fraction[1] >> 63U);
    fraction[1] = (fraction[1] << 1U) | (fraction[2] >> 63U);
    fraction[2] <<= 1U;
    ++scale;
  }
  const double unit = std::bit_cast<double>((1023U - 53U - scale) << 52U);
  const double f_high = static_cast<double>(fraction[0] >> 11U) * unit;
  const double f_low = static_cast<double>(((fraction[0] & 0x7FFU) << 42U) | (fraction[1] >> 22U)) * (unit * 0x1p-53);
  constexpr HighLow kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
  const HighLow product = two_product(f_high, kHalfPi.high);
  const double rest = product.low + (f_high * kHalfPi.low + f_low * kHalfPi.high);
  const double high = product.high + rest;
  return {high, (high - product.high) - rest, 0};
}

ReducedAngle reduce_large(double angle_rad) {
  QuarterTurns turns = quarter_turns(angle_rad);
  // Above one half, the next quarter turn is nearer: 1 - fraction, negative.
  const bool is_above_half = (turns.fraction[0] >> 63U) != 0;
  if (is_above_half) {
    ++turns.whole;
    for (std::uint64_t& word : turns.fraction) {
      word = ~word;
    }
  }
  ReducedAngle reduced = angle_of_fraction(turns.fraction);
  if (is_above_half != std::signbit(angle_rad)) {
    reduced.high = -reduced.high;
    reduced.excess = -reduced.excess;
  }
  reduced.quadrant = (std::signbit(angle_rad) ? 0U - turns.whole : turns.whole) & 3U;
  return reduced;
}

}  // namespace

ReducedAngle reduce_by_half_pi(double angle_rad) {
  constexpr double kLargest = 2e5;  // fewer than 2^17 quarter turns
  return std::fabs(angle_rad) <= kLargest ? reduce_small(angle_rad) : reduce_large(angle_rad);
}

}  // namespace gdtslam::elementary
