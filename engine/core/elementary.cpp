#include "elementary.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "double_double.hpp"
#include "elementary_tables.hpp"

namespace gdtslam {
namespace shader {

// shaders/common/elementary.glsl as C++: the few names of GLSL that it uses.
inline std::int32_t floatBitsToInt(float value) { return std::bit_cast<std::int32_t>(value); }
inline float intBitsToFloat(std::int32_t bits) { return std::bit_cast<float>(bits); }

// The build turns contraction off, as `precise` does in a shader compiler.
#define precise
#include "elementary.glsl"
#undef precise

}  // namespace shader

namespace elementary {
namespace {

/// angle = n pi/2 + high - excess with |high| <= pi/4 (by a hair more), |excess| below an ulp of high, quadrant = n
/// mod 4. A difference, since -0 - (+0) keeps the sign of an angle of -0 and a sum would not.
struct ReducedAngle {
  double high;
  double excess;
  std::uint64_t quadrant;
};

// Cody and Waite [Cody1980]: n pi/2 is subtracted piece by piece; the products with the pieces are exact.
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
  // Close to a multiple of pi/2 the third and the fourth piece also count, and each difference keeps its rounding
  // error.
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

// Payne and Hanek [Payne1983]: only those bits of 2/pi count that meet the mantissa between 4 quarter turns and the
// last wanted bit.
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

/// Any finite angle. Relative error of the remainder below 2^-63.
ReducedAngle reduce_by_half_pi(double angle_rad) {
  constexpr double kLargest = 2e5;  // fewer than 2^17 quarter turns
  return std::fabs(angle_rad) <= kLargest ? reduce_small(angle_rad) : reduce_large(angle_rad);
}

}  // namespace
}  // namespace elementary

namespace {

using elementary::fast_two_sum;
using elementary::HighLow;
using elementary::two_product;
using elementary::two_sum;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <std::size_t kCount>
double horner(const std::array<double, kCount>& coefficients, double t) {
  double sum = coefficients[kCount - 1];
  for (std::size_t i = kCount - 1; i-- > 0;) {
    sum = sum * t + coefficients[i];
  }
  return sum;
}

double power_of_two(std::int64_t exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52U);
}

// The exponent of a positive normal number.
std::int64_t binary_exponent(double value) {
  return static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value) >> 52U) - 1023;
}

}  // namespace

SinCos<double> sin_cos(double angle_rad) {
  if (!std::isfinite(angle_rad)) {
    return {kNan, kNan};
  }
  const elementary::ReducedAngle angle = elementary::reduce_by_half_pi(angle_rad);
  const double r = angle.high;
  const double t = r * r;
  const double half_t = 0.5 * t;
  const double c_head = 1.0 - half_t;
  const double s = r - (angle.excess * c_head - (r * t) * horner(elementary::kSin, t));
  const double c = c_head + (((1.0 - c_head) - half_t) + ((t * t) * horner(elementary::kCos, t) + r * angle.excess));
  // Odd quarter turns exchange the two, quarter turns 2 and 3 (for the cosine 1 and 2) change the sign; by bits, so
  // that nothing branches.
  const auto s_bits = std::bit_cast<std::uint64_t>(s);
  const auto c_bits = std::bit_cast<std::uint64_t>(c);
  const std::uint64_t exchange = (s_bits ^ c_bits) & (0U - (angle.quadrant & 1U));
  return {std::bit_cast<double>(s_bits ^ exchange ^ ((angle.quadrant & 2U) << 62U)),
          std::bit_cast<double>(c_bits ^ exchange ^ (((angle.quadrant + 1U) & 2U) << 62U))};
}

SinCos<float> sin_cos(float angle_rad) {
  const shader::SinCosF32 value = shader::sin_cos_f32(angle_rad);
  return {value.sin_value, value.cos_value};
}

namespace {

// atan(b / a) for 0 < b <= a, both between 2^-60 and 2^60, as a sum of two doubles. With c = k/8 next to b/a,
// atan(b/a) = atan(c) + atan((b - c a) / (a + c b)), and the quotient is carried with its remainder.
HighLow atan_of_ratio(double b, double a) {
  const double nearest = std::floor(8.0 * (b / a) + 0.5);
  const double c = 0.125 * nearest;
  const HighLow ca = two_product(c, a);
  const HighLow cb = two_product(c, b);
  HighLow numerator = two_sum(b, -ca.high);
  numerator.low -= ca.low;
  HighLow denominator = fast_two_sum(a, cb.high);
  denominator.low += cb.low;
  const double inverse = 1.0 / denominator.high;
  const double r = numerator.high * inverse;
  const HighLow back = two_product(r, denominator.high);
  const double r_low = (((numerator.high - back.high) - back.low) + (numerator.low - r * denominator.low)) * inverse;
  const double t = r * r;
  const HighLow& table = elementary::kAtanOfEighth[static_cast<std::size_t>(nearest)];
  const HighLow sum = fast_two_sum(table.high, r);
  return {sum.high, sum.low + (table.low + (r_low + (r * t) * horner(elementary::kAtan, t)))};
}

constexpr HighLow kPiHighLow = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr HighLow kHalfPiHighLow = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

// The angle of (x, y) from the angle of (larger, smaller) of |x| and y: base + sign * angle.
struct Octant {
  HighLow base;
  double sign;
};
constexpr std::array<Octant, 4> kOctants = {{
    {{0.0, 0.0}, 1.0},       // x > 0, y <= x
    {kHalfPiHighLow, -1.0},  // x > 0, y > x
    {kPiHighLow, -1.0},      // x < 0, y <= -x
    {kHalfPiHighLow, 1.0},   // x < 0, y > -x
}};

// atan2 for 0 < y, x != 0, both finite.
double atan2_upper(double y, double x) {
  const double width = std::fabs(x);
  constexpr double kFar = 0x1p30;
  if (y < width / kFar) {
    // atan(t) = t to the last bit.
    return x > 0.0 ? y / x : kPiHighLow.high - (y / width - kPiHighLow.low);
  }
  if (width < y / kFar) {
    return kHalfPiHighLow.high - (x / y - kHalfPiHighLow.low);
  }
  // Both are within 2^30 of each other here; scaled, so that no product overflows or loses bits.
  const double larger = y > width ? y : width;
  const double into_range = larger < 0x1p-500 ? 0x1p600 : (larger > 0x1p500 ? 0x1p-600 : 1.0);
  const double scale = power_of_two(-binary_exponent(larger * into_range));
  const double smaller = y > width ? width : y;
  const HighLow angle = atan_of_ratio(smaller * into_range * scale, larger * into_range * scale);
  const Octant& octant = kOctants[(x < 0.0 ? 2U : 0U) + (y > width ? 1U : 0U)];
  const HighLow sum = fast_two_sum(octant.base.high, octant.sign * angle.high);
  return sum.high + (sum.low + (octant.base.low + octant.sign * angle.low));
}

// atan2 with a zero or an infinity among the arguments; y >= 0 by sign.
double atan2_upper_special(double y, double x) {
  const bool is_left = std::signbit(x);
  if (std::isinf(x) && std::isinf(y)) {
    return is_left ? 0x1.2d97c7f3321d2p+1 : 0x1.921fb54442d18p-1;
  }
  if (std::isinf(x) || (y == 0.0 && !std::isinf(y))) {
    return is_left ? kPiHighLow.high : 0.0;
  }
  return kHalfPiHighLow.high;
}

}  // namespace

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) {
    return kNan;
  }
  const double height = std::fabs(y);
  const bool is_special = x == 0.0 || height == 0.0 || std::isinf(x) || std::isinf(height);
  return std::copysign(is_special ? atan2_upper_special(height, x) : atan2_upper(height, x), y);
}

double exp(double x) {
  if (std::isnan(x)) {
    return kNan;
  }
  if (x > 709.8) {
    return kInfinity;
  }
  if (x < -745.2) {
    return 0.0;
  }
  constexpr double kSteps = static_cast<double>(elementary::kExp2.size());
  constexpr double kStepsPerUnit = 0x1.71547652b82fep+0 * kSteps;  // 1 / ln(2)
  const double n = std::floor(x * kStepsPerUnit + 0.5);
  const double r_high = x - n * elementary::kLn2Parts[0];
  const double r_low = n * elementary::kLn2Parts[1];
  const double r = r_high - r_low;
  const double lost = (r_high - r) - r_low;
  const auto step = static_cast<std::int64_t>(n);
  const std::int64_t fraction = step & (static_cast<std::int64_t>(elementary::kExp2.size()) - 1);
  const std::int64_t whole = (step - fraction) / static_cast<std::int64_t>(elementary::kExp2.size());
  const HighLow& table = elementary::kExp2[static_cast<std::size_t>(fraction)];
  const double growth = r + (lost + (r * r) * horner(elementary::kExp, r));
  const double value = table.high + (table.low + table.high * growth);
  // In two factors, since 2^whole alone may be no double; the first is exact, the second rounds at most once.
  const std::int64_t half = whole / 2;
  return value * power_of_two(half) * power_of_two(whole - half);
}

double log(double x) {
  if (std::isnan(x) || x < 0.0) {
    return kNan;
  }
  if (x == 0.0) {
    return -kInfinity;
  }
  if (std::isinf(x)) {
    return x;
  }
  const bool is_subnormal = x < std::numeric_limits<double>::min();
  const double normal = is_subnormal ? x * 0x1p54 : x;
  // x = 2^exponent m with m in [0.703, 1.406): around 1 the exponent is 0 and nothing cancels.
  constexpr std::uint64_t kLowest = 0x3FE6800000000000U;  // 0.703125 = 90/128
  const std::uint64_t above = std::bit_cast<std::uint64_t>(normal) - kLowest;
  const std::int64_t exponent = static_cast<std::int64_t>(above) >> 52;
  const double m = std::bit_cast<double>((above & 0x000FFFFFFFFFFFFFU) + kLowest);
  const auto j = static_cast<std::int64_t>(m * 128.0 + 0.5);
  const elementary::LogStep& step = elementary::kLogSteps[static_cast<std::size_t>(j - elementary::kFirstLogStep)];
  // m c - 1 without rounding: c has at most ten bits, m is cut into two halves.
  const double m_high = std::bit_cast<double>(std::bit_cast<std::uint64_t>(m) & 0xFFFFFFFFF0000000U);
  const HighLow r = two_sum(m_high * step.inverse - 1.0, (m - m_high) * step.inverse);
  const double k = static_cast<double>(exponent - (is_subnormal ? 54 : 0));
  const double head = k * elementary::kLn2[0] + step.high;
  const double half_square = 0.5 * r.high * r.high;
  const HighLow sum = fast_two_sum(head, r.high);
  const double cube = (r.high * r.high) * r.high * horner(elementary::kLog, r.high);
  const double rest = sum.low + ((r.low + (k * elementary::kLn2[1] + step.low)) + cube);
  return sum.high + (rest - half_square);
}

}  // namespace gdtslam
