// Sums and products of doubles with their rounding errors, by additions and multiplications alone. Thread-safe,
// constant time.
#pragma once

namespace gdtslam::elementary {

/// A number as the sum of a double and a correction below half an ulp of it.
struct HighLow {
  double high;
  double low;
};

/// a + b and its rounding error; |a| >= |b| or a = 0 [Dekker1971].
inline HighLow fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a + b and its rounding error [Knuth1998].
inline HighLow two_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a * b and its rounding error [Dekker1971]; both below 2^996.
inline HighLow two_product(double a, double b) {
  constexpr double kSplitter = 0x1p27 + 1.0;
  const double a_big = kSplitter * a;
  const double a_high = a_big - (a_big - a);
  const double a_low = a - a_high;
  const double b_big = kSplitter * b;
  const double b_high = b_big - (b_big - b);
  const double b_low = b - b_high;
  const double product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

}  // namespace gdtslam::elementary
