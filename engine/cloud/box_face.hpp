// The plane of a box's face as a frame, the points of a cloud as that face sees them, and where it ends: what its beams
// hit on it and past it. Metres.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

struct FaceFrame {
  Point3 origin = Point3::Zero();
  Point3 normal = Point3::UnitX();  ///< outwards, towards the viewpoint
  Point3 across = Point3::UnitY();
  Point3 up = Point3::UnitZ();
};

enum class FaceAxis : std::uint8_t { kAcross, kUp };

struct Span {
  double low_m = 0.0;
  double high_m = 0.0;
  [[nodiscard]] double length_m() const { return high_m - low_m; }
  [[nodiscard]] bool has(double value_m) const { return value_m >= low_m && value_m <= high_m; }
  /// Without this share at each end.
  [[nodiscard]] Span inner(double share) const { return {low_m + share * length_m(), high_m - share * length_m()}; }
  [[nodiscard]] Span grown(double by_m) const { return {low_m - by_m, high_m + by_m}; }
};

/// One point and where its beam crosses the plane of the face.
struct FaceHit {
  double across_m = 0.0;  ///< coordinate of the crossing
  double up_m = 0.0;
  double depth_m = 0.0;         ///< depth of the point behind the plane
  double point_across_m = 0.0;  ///< coordinate of the point itself
  double point_up_m = 0.0;
  [[nodiscard]] double along(FaceAxis axis) const { return axis == FaceAxis::kAcross ? across_m : up_m; }
  [[nodiscard]] double beside(FaceAxis axis) const { return axis == FaceAxis::kAcross ? up_m : across_m; }
  [[nodiscard]] double point_along(FaceAxis axis) const {
    return axis == FaceAxis::kAcross ? point_across_m : point_up_m;
  }
  [[nodiscard]] double point_beside(FaceAxis axis) const {
    return axis == FaceAxis::kAcross ? point_up_m : point_across_m;
  }
};

/// Finds the points whose beam crosses the plane within the spans, or that lie before or behind that part of it.
/// Without a viewpoint beams are taken to run along the normal, and points farther than `thickness_m` from the plane
/// count for themselves only (their crossing is not a number).
std::vector<FaceHit> find_hits(std::span<const CloudPoint> cloud, const FaceFrame& face, const Span& across,
                               const Span& up, const std::optional<Point3>& viewpoint, double thickness_m);

enum class EndKind : std::uint8_t {
  kJump,      ///< beams past it go on to something behind
  kCrease,    ///< another face of the box begins there
  kStops,     ///< no point was hit past it
  kHidden,    ///< something before it, or a surface that it meets, comes first
  kContinues  ///< the plane goes on
};

struct FaceEnd {
  double at_m = 0.0;
  double sigma_m = 0.0;
  EndKind kind = EndKind::kStops;
};

/// Which end of which axis: sign 1 is the high end.
struct EndPlace {
  FaceAxis axis = FaceAxis::kAcross;
  double sign = 1.0;
  double rough_m = 0.0;     ///< roughness of the face's outermost points
  double sampling_m = 0.0;  ///< from beam to beam along the axis
  Span beside;              ///< span of the face in the other axis, away from its ends
  /// Position of the scanner, if it is known: along the axis, and before the plane.
  std::optional<double> eye_along_m = std::nullopt;
  double eye_before_m = 0.0;
};

/// The end between the beams that hit the face and those that passed it. Each beam near it says on which side of the
/// end it went by; a logistic error of the beams' directions is allowed for. The answer is the mean and the standard
/// deviation over all ends and errors, as likely as they explain the beams: exact between two beams, and honest where
/// no beam went close by.
FaceEnd find_end(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m);

/// A face that begins at an end and goes back from it: x = at + slope * depth.
struct SideFace {
  FaceEnd crease;
  double slope = 0.0;
  double sigma_slope = 0.0;
  double rms_m = 0.0;
  double deepest_m = 0.0;
  std::uint32_t points = 0;
};
/// Finds a side face; empty if too little of it is seen. If the scanner is known, the slope is that for errors along
/// the beams: a side seen at a low angle would else be turned by the errors of its points' depths.
std::optional<SideFace> side_at(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m,
                                double max_depth_m);

}  // namespace gdtslam
