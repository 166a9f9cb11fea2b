// Kinematics of the planar four-bar linkage in closed form [Norton2012, McCarthy2011]. The crank's pivot is the origin,
// the rocker's pivot lies at (ground, 0); crank angle phi and rocker angle psi are measured from the ground line
// (+x), counter-clockwise, radians; lengths in metres. The assembly mode is an explicit input and never flips: `open`
// has the coupler joint B on the left of the line from the crank's end A to the rocker's pivot, `crossed` on its right.
// Thread-safe, constant time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam::calib {

/// The lengths of the four bars.
struct FourBar {
  double crank_m = 0.0;
  double coupler_m = 0.0;
  double rocker_m = 0.0;
  double ground_m = 0.0;
};

/// The bars of a nodding mount are about a hand long. A value far from that is most likely in another unit.
inline constexpr double kLeastBar_m = 0.001;
inline constexpr double kMostBar_m = 1.0;

enum class Assembly : std::uint8_t { kOpen, kCrossed };

/// Class by Grashof's inequality and the position of the shortest bar.
enum class GrashofClass : std::uint8_t {
  kCrankRocker,   ///< the crank is the shortest bar: it turns fully, the rocker swings
  kDoubleCrank,   ///< the ground is the shortest: both turn fully (drag link)
  kRockerCrank,   ///< the rocker is the shortest: it would turn fully, the crank swings
  kDoubleRocker,  ///< the coupler is the shortest: neither turns fully
  kTripleRocker,  ///< s + l > p + q: nothing turns fully
  kChangePoint,   ///< s + l = p + q within 1e-9 of it: the linkage can fall flat and change its mode
};

/// Angles of coupler and rocker at one crank angle.
struct LinkagePose {
  double coupler_rad = 0.0;       ///< direction from A to B
  double rocker_rad = 0.0;        ///< psi, in (-pi, pi]
  double transmission_rad = 0.0;  ///< angle between coupler and rocker at B, folded to [0, pi/2]
};

/// First and second derivative of the angles, for a crank that turns with the given rate and acceleration.
struct LinkageMotion {
  double coupler_rate = 0.0;
  double rocker_rate = 0.0;
  double coupler_acceleration = 0.0;
  double rocker_acceleration = 0.0;
};

/// d psi / d length (rad per metre).
struct RockerSensitivity {
  double crank = 0.0;
  double coupler = 0.0;
  double rocker = 0.0;
  double ground = 0.0;
};

/// Crank angles at which the loop closes, from one end counter-clockwise to the other.
struct CrankRange {
  double from_rad = 0.0;
  double to_rad = 0.0;
};

/// A position at which the rocker reverses.
struct DeadPoint {
  double crank_rad = 0.0;
  double rocker_rad = 0.0;
};

/// K1..K3 of K1 cos psi - K2 cos phi + K3 = cos(phi - psi) [Freudenstein1954].
struct FreudensteinCoefficients {
  double k1 = 0.0;
  double k2 = 0.0;
  double k3 = 0.0;
};

/// Faults of the lengths, one sentence each: not positive, not finite, or a bar longer than the other three together,
/// with the inequality and its numbers. Empty if the loop can close somewhere.
std::vector<std::string> violations(const FourBar& bars);
/// Grashof's condition compares shortest plus longest bar with the sum of the other two. If it is less, the shortest
/// bar turns fully.
struct GrashofInequality {
  double extremes_m = 0.0;
  double middles_m = 0.0;
};
GrashofInequality grashof_inequality(const FourBar& bars);
GrashofClass grashof_class(const FourBar& bars);
/// "crank-rocker", "double crank", "rocker-crank", "double rocker", "triple rocker", "change point".
const char* class_name(GrashofClass grashof);

/// Empty if the loop does not close at this crank angle.
std::optional<LinkagePose> solve(const FourBar& bars, Assembly assembly, double crank_rad);
/// Empty if the loop does not close, or at a dead point of the crank, where the rates are unbounded.
std::optional<LinkageMotion> motion(const FourBar& bars, Assembly assembly, double crank_rad, double crank_rate = 1.0,
                                    double crank_acceleration = 0.0);
std::optional<RockerSensitivity> sensitivity(const FourBar& bars, Assembly assembly, double crank_rad);
/// A point fixed to the coupler, `along` it from A and `across` to its left.
std::optional<Point2> coupler_point(const FourBar& bars, Assembly assembly, double crank_rad, double along_m,
                                    double across_m);
/// Crank angles at which the loop closes: one whole turn, or the ranges between its limits.
std::vector<CrankRange> crank_ranges(const FourBar& bars);
FreudensteinCoefficients freudenstein(const FourBar& bars);

}  // namespace gdtslam::calib
