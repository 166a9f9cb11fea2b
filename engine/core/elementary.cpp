#include "elementary.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "double_double.hpp"
#include "elementary_tables.hpp"
#include "half_pi_reduction.hpp"
#include "sin_cos_f32.hpp"

namespace gdtslam {
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
std::int64_t exponent_of(double value) {
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
  const double scale = power_of_two(-exponent_of(larger * into_range));
  const double smaller = y > width ? width : y;
  const HighLow angle = atan_of_ratio(smaller * into_range * scale, larger * into_range * scale);
  const Octant& octant = kOctants[(x < 0.0 ? 2U : 0U) + (y > width ? 1U : 0U)];
  const HighLow sum = fast_two_sum(octant.base.high, octant.sign * angle.high);
  return sum.high + (sum.low + (octant.base.low + octant.sign * angle.low));
}

// atan2 where a zero or an infinity is among the arguments; y >= 0 by sign.
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
