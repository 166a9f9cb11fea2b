// Float32 arithmetic of the oracles.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

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

/// 1 / value by three steps of Newton.
inline Single reciprocal(Single value) {
  Single r{std::bit_cast<float>(0x7EF311C7U - std::bit_cast<std::uint32_t>(value.value))};
  for (int step = 0; step < 3; ++step) r = r * (Single{2.0F} - value * r);
  return r;
}

/// The upper half of the lanes is added to the lower one until one is left.
template <std::size_t kLanes>
Single sum_of(std::array<Single, kLanes> lanes) {
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t i = 0; i < half; ++i) lanes[i] = lanes[i] + lanes[i + half];
  }
  return lanes[0];
}

}  // namespace gdtslam::test
