// The elementary functions against MPFR [Fousse2007], which rounds correctly: random arguments over every scale, and
// the hard ones. Bounds are what docs/numerics.md promises; the figures found are printed as test properties.
#include "engine/core/elementary.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "mpfr_oracle.hpp"

namespace gdtslam {
namespace {

using test::BigFloat;
using test::ulps_double;
using test::ulps_float;
using test::WorstCase;

constexpr int kTries = 40000;

class Arguments {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11U) * 0x1p-53);
  }
  std::int64_t whole(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  /// Any finite double with an exponent in the range, either sign.
  double of_exponent(std::int64_t low, std::int64_t high) {
    const double sign = (engine_() & 1U) != 0 ? -1.0 : 1.0;
    return std::ldexp(sign * uniform(1.0, 2.0), static_cast<int>(whole(low, high)));
  }
  double any_bits() { return std::bit_cast<double>(engine_()); }

 private:
  std::mt19937_64 engine_{12345};
};

void expect_within(const WorstCase& worst, double bound_ulps) {
  testing::Test::RecordProperty("worst_ulps", std::to_string(worst.ulps));
  EXPECT_LE(worst.ulps, bound_ulps) << std::hexfloat << "at " << worst.x << ", " << worst.y;
}

// Neighbours of x, so that the doubles closest to an awkward real number are among them.
template <class Check>
void around(double x, Check check) {
  for (double step = -3.0; step <= 3.0; step += 1.0) {
    check(x + step * (std::nextafter(std::fabs(x), HUGE_VAL) - std::fabs(x)));
  }
}

struct SinCosWorst {
  WorstCase worst;
  void check(double x) {
    const BigFloat argument(x);
    BigFloat sine;
    BigFloat cosine;
    mpfr_sin_cos(sine.get(), cosine.get(), argument.get(), MPFR_RNDN);
    const SinCos<double> found = sin_cos(x);
    worst.take(ulps_double(found.sin, sine), x);
    worst.take(ulps_double(found.cos, cosine), x);
  }
};

TEST(SinCosOracle, RandomAnglesOfEveryScale) {
  Arguments arguments;
  SinCosWorst sin_cos_worst;
  for (const double limit : {1e-3, 0.8, 3.2, 100.0, 1e5, 2.1e5}) {
    for (int i = 0; i < kTries; ++i) {
      sin_cos_worst.check(arguments.uniform(-limit, limit));
    }
  }
  expect_within(sin_cos_worst.worst, 0.85);
}

TEST(SinCosOracle, MultiplesOfAQuarterTurn) {
  Arguments arguments;
  SinCosWorst sin_cos_worst;
  for (int n = 0; n < 2000; ++n) {
    around(n * (std::numbers::pi / 2.0), [&](double x) { sin_cos_worst.check(x); });
    around(n * (std::numbers::pi / 4.0), [&](double x) { sin_cos_worst.check(-x); });
  }
  for (int i = 0; i < kTries / 8; ++i) {
    const double n = static_cast<double>(arguments.whole(0, 130000));
    around(n * (std::numbers::pi / 2.0), [&](double x) { sin_cos_worst.check(x); });
  }
  expect_within(sin_cos_worst.worst, 0.85);
}

// 6381956970095103 * 2^797 is the double that comes closest to a multiple of pi/2 [Muller2018].
TEST(SinCosOracle, HugeAngles) {
  Arguments arguments;
  SinCosWorst sin_cos_worst;
  sin_cos_worst.check(std::ldexp(6381956970095103.0, 797));
  sin_cos_worst.check(-std::ldexp(6381956970095103.0, 797));
  sin_cos_worst.check(std::numeric_limits<double>::max());
  around(2e5, [&](double x) { sin_cos_worst.check(x); });
  for (int i = 0; i < kTries; ++i) {
    sin_cos_worst.check(arguments.of_exponent(15, 1023));
  }
  expect_within(sin_cos_worst.worst, 0.85);
}

TEST(SinCosOracle, TinyAngles) {
  Arguments arguments;
  SinCosWorst sin_cos_worst;
  for (int i = 0; i < kTries; ++i) {
    sin_cos_worst.check(arguments.of_exponent(-1074, -1));
  }
  expect_within(sin_cos_worst.worst, 0.85);
}

TEST(SinCosOracle, SinglePrecision) {
  WorstCase worst;
  const auto check = [&](float x) {
    const BigFloat argument(static_cast<double>(x));
    BigFloat sine;
    BigFloat cosine;
    mpfr_sin_cos(sine.get(), cosine.get(), argument.get(), MPFR_RNDN);
    const SinCos<float> found = sin_cos(x);
    worst.take(ulps_float(found.sin, sine), static_cast<double>(x));
    worst.take(ulps_float(found.cos, cosine), static_cast<double>(x));
  };
  // Every 20011th float from 0 to 64, and the floats closest to the multiples of pi/2.
  for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(64.0F); bits += 20011) {
    check(std::bit_cast<float>(bits));
    check(-std::bit_cast<float>(bits));
  }
  for (int n = 0; n <= 40; ++n) {
    const auto nearest = static_cast<float>(n * (std::numbers::pi / 2.0));
    check(nearest);
    check(std::nextafter(nearest, 64.0F));
    check(std::nextafter(nearest, 0.0F));
  }
  expect_within(worst, 1.0);
}

struct Atan2Worst {
  WorstCase worst;
  void check(double y, double x) {
    BigFloat exact;
    mpfr_atan2(exact.get(), BigFloat(y).get(), BigFloat(x).get(), MPFR_RNDN);
    worst.take(ulps_double(atan2(y, x), exact), x, y);
  }
};

TEST(Atan2Oracle, AllDirections) {
  Arguments arguments;
  Atan2Worst atan2_worst;
  for (int i = 0; i < 3 * kTries; ++i) {
    atan2_worst.check(arguments.uniform(-1.0, 1.0), arguments.uniform(-1.0, 1.0));
  }
  expect_within(atan2_worst.worst, 0.55);
}

TEST(Atan2Oracle, AllScales) {
  Arguments arguments;
  Atan2Worst atan2_worst;
  for (int i = 0; i < kTries; ++i) {
    atan2_worst.check(arguments.of_exponent(-1074, 1023), arguments.of_exponent(-1074, 1023));
    const double x = arguments.of_exponent(-1030, 980);
    atan2_worst.check(x * arguments.of_exponent(-40, 40), x);
  }
  expect_within(atan2_worst.worst, 0.55);
}

// Where the table's interval changes, where the quotient is cut off as tiny, and the diagonals.
TEST(Atan2Oracle, Seams) {
  Arguments arguments;
  Atan2Worst atan2_worst;
  for (int i = 0; i < kTries / 10; ++i) {
    const double x = arguments.of_exponent(-2, 2);
    const double sixteenth = static_cast<double>(arguments.whole(-16, 16)) / 16.0;
    around(sixteenth * x, [&](double y) {
      atan2_worst.check(y, x);
      atan2_worst.check(x, y);
    });
    around(x * 0x1p-30, [&](double y) {
      atan2_worst.check(y, x);
      atan2_worst.check(x, y);
    });
  }
  expect_within(atan2_worst.worst, 0.55);
}

struct ExpWorst {
  WorstCase worst;
  void check(double x) {
    BigFloat exact;
    mpfr_exp(exact.get(), BigFloat(x).get(), MPFR_RNDN);
    worst.take(ulps_double(exp(x), exact), x);
  }
};

TEST(ExpOracle, NormalResults) {
  Arguments arguments;
  ExpWorst exp_worst;
  for (const double limit : {1e-8, 0.01, 1.0, 50.0, 708.0}) {
    for (int i = 0; i < kTries; ++i) {
      exp_worst.check(arguments.uniform(-limit, limit));
    }
  }
  for (int k = -1022; k <= 1023; ++k) {
    around(k * std::numbers::ln2, [&](double x) { exp_worst.check(x); });
    around((k + 0.5) * (std::numbers::ln2 / 64.0), [&](double x) { exp_worst.check(x); });
  }
  expect_within(exp_worst.worst, 0.52);
}

TEST(ExpOracle, SubnormalResults) {
  Arguments arguments;
  ExpWorst exp_worst;
  for (int i = 0; i < kTries; ++i) {
    exp_worst.check(arguments.uniform(-745.13, -708.0));
  }
  expect_within(exp_worst.worst, 0.76);
}

struct LogWorst {
  WorstCase worst;
  void check(double x) {
    BigFloat exact;
    mpfr_log(exact.get(), BigFloat(x).get(), MPFR_RNDN);
    worst.take(ulps_double(log(x), exact), x);
  }
};

TEST(LogOracle, AllScales) {
  Arguments arguments;
  LogWorst log_worst;
  for (int i = 0; i < 3 * kTries; ++i) {
    log_worst.check(std::fabs(arguments.of_exponent(-1074, 1023)));
  }
  expect_within(log_worst.worst, 0.52);
}

// Around 1 the result is tiny and every digit of it must come from the argument's last bits.
TEST(LogOracle, AroundOne) {
  Arguments arguments;
  LogWorst log_worst;
  for (int i = 0; i < kTries; ++i) {
    log_worst.check(1.0 + arguments.of_exponent(-53, -1));
    log_worst.check(arguments.uniform(0.5, 2.0));
  }
  around(1.0, [&](double x) { log_worst.check(x); });
  expect_within(log_worst.worst, 0.52);
}

TEST(LogOracle, Seams) {
  LogWorst log_worst;
  for (int j = 1; j <= 512; ++j) {
    around(j / 256.0, [&](double x) { log_worst.check(x); });
  }
  around(std::numeric_limits<double>::min(), [&](double x) { log_worst.check(x); });
  log_worst.check(std::numeric_limits<double>::denorm_min());
  log_worst.check(std::numeric_limits<double>::max());
  expect_within(log_worst.worst, 0.52);
}

}  // namespace
}  // namespace gdtslam
