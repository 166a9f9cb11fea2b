// Angles in radians. Thread-safe, constant time.
#pragma once

namespace gdtslam {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2.0 * kPi;

constexpr double rad_from_deg(double angle_deg) { return angle_deg * (kPi / 180.0); }
constexpr double deg_from_rad(double angle_rad) { return angle_rad * (180.0 / kPi); }

/// The same angle in (-pi, pi]. NaN and infinities give NaN.
double wrap_angle(double angle_rad);

}  // namespace gdtslam
