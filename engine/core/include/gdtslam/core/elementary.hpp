// The project's own elementary functions, the same bits on every host: adds, multiplies and correctly rounded
// divisions and square roots only, no contraction (docs/numerics.md gives the error of each, measured against MPFR).
// The C library is not used because it picks variants by CPU. Thread-safe, constant time.
#pragma once

namespace gdtslam {

template <class T>
struct SinCos {
  T sin;
  T cos;
};

/// sin and cos of an angle in radians; at most 1 ulp off for |angle| <= 1e5, NaN for what is not finite.
SinCos<double> sin_cos(double angle_rad);
/// Single precision, the same source as the shaders (shaders/common/elementary.glsl), |angle| <= 64.
SinCos<float> sin_cos(float angle_rad);

/// Angle of (x, y) in [-pi, pi]; signed zeros as in IEEE 754; at most 1 ulp off.
double atan2(double y, double x);
/// e^x; 0 below, infinity above the range of double.
double exp(double x);
/// Natural logarithm; -infinity at 0, NaN below.
double log(double x);

}  // namespace gdtslam
