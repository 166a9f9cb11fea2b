// The exact values of elementary functions by MPFR, and the error of a double or a float against them in units in the
// last place of the exact value.
#pragma once

#include <mpfr.h>

#include <cmath>
#include <limits>

namespace gdtslam::test {

/// A number of 256 bits: enough for every double argument, the value's cancellation included, since MPFR rounds
/// correctly.
class BigFloat {
 public:
  BigFloat() { mpfr_init2(value_, 256); }
  explicit BigFloat(double value) : BigFloat() { mpfr_set_d(value_, value, MPFR_RNDN); }
  BigFloat(const BigFloat&) = delete;
  BigFloat& operator=(const BigFloat&) = delete;
  ~BigFloat() { mpfr_clear(value_); }

  mpfr_ptr get() { return value_; }
  [[nodiscard]] mpfr_srcptr get() const { return value_; }
  [[nodiscard]] double rounded() const { return mpfr_get_d(value_, MPFR_RNDN); }

 private:
  mpfr_t value_;
};

/// |found - exact| in units of the last place that a format with so many bits and this least exponent has at `exact`.
inline double ulps_in_format(double found, const BigFloat& exact, int bits, int least_exponent) {
  if (mpfr_zero_p(exact.get()) != 0) {
    return found == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (!std::isfinite(found)) {
    return std::numeric_limits<double>::infinity();
  }
  const auto exponent = static_cast<int>(mpfr_get_exp(exact.get())) - bits;
  BigFloat difference;
  mpfr_sub_d(difference.get(), exact.get(), found, MPFR_RNDN);
  mpfr_abs(difference.get(), difference.get(), MPFR_RNDN);
  mpfr_mul_2si(difference.get(), difference.get(), -(exponent > least_exponent ? exponent : least_exponent), MPFR_RNDN);
  return difference.rounded();
}

inline double ulps_double(double found, const BigFloat& exact) { return ulps_in_format(found, exact, 53, -1074); }
inline double ulps_float(float found, const BigFloat& exact) {
  return ulps_in_format(static_cast<double>(found), exact, 24, -149);
}

/// The largest error of a series of tries and where it was.
struct WorstCase {
  double ulps = 0.0;
  double x = 0.0;
  double y = 0.0;
  void take(double error_ulps, double at_x, double at_y = 0.0) {
    // Written so that NaN is taken.
    if (!(error_ulps <= ulps)) {
      *this = {error_ulps, at_x, at_y};
    }
  }
};

}  // namespace gdtslam::test
