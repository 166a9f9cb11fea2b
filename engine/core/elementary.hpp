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

/// sin and cos of an angle in radians; at most 1 ulp off for every finite angle, else NaN. Above 2e5 the reduction
/// takes about five times as long.
SinCos<double> sin_cos(double angle_rad);
/// Single precision, the same source as the shaders (shaders/common/elementary.glsl) and branch-free; at most 1 ulp off
/// for |angle| <= 64, beyond that the error grows. NaN if the angle is not finite.
SinCos<float> sin_cos(float angle_rad);

/// Angle of (x, y) in [-pi, pi]; zeros, infinities and NaN as in IEEE 754; at most 1 ulp off.
double atan2(double y, double x);
/// e^x; 0 below, infinity above the range of double; at most 1 ulp off, subnormal results included.
double exp(double x);
/// Natural logarithm; -infinity at 0, NaN below; at most 1 ulp off.
double log(double x);

}  // namespace gdtslam
