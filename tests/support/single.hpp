// Float32 arithmetic of the oracles.
#pragma once

namespace gdtslam::test {

/// A float32. Each operation runs in double and its result is rounded to float32, which is the correctly rounded
/// result: 53 bits are more than 2 * 24 + 2. The compiler cannot contract two operations.
struct Single {
  float value = 0.0F;
  friend Single operator+(Single a, Single b) { return rounded(wide(a) + wide(b)); }
  friend Single operator-(Single a, Single b) { return rounded(wide(a) - wide(b)); }
  friend Single operator*(Single a, Single b) { return rounded(wide(a) * wide(b)); }

 private:
  static double wide(Single a) { return static_cast<double>(a.value); }
  static Single rounded(double exact) { return {static_cast<float>(exact)}; }
};

}  // namespace gdtslam::test
