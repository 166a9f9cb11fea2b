// sin(a)/a with the cosine of the same angle: what an arc and its chord have in common. Thread-safe, constant time.
#pragma once

#include "elementary.hpp"

namespace gdtslam {

struct HalfTurn {
  double sin = 0.0;
  double cos = 1.0;
  double sinc = 1.0;  ///< sin(a) / a, 1 at 0
};

/// The chord of an arc that turns by 2a is the arc's length times sinc, pointing a to the left of the start.
inline HalfTurn half_turn(double a_rad) {
  const SinCos<double> value = sin_cos(a_rad);
  return {value.sin, value.cos, a_rad == 0.0 ? 1.0 : value.sin / a_rad};
}

}  // namespace gdtslam
