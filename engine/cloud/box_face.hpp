// The frame of a box's face, the points of a cloud seen in it, and the ends of the face by the beams that hit it and
// those that pass it. Metres.
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
  /// The span without this share at each end.
  [[nodiscard]] Span inner(double share) const { return {low_m + share * length_m(), high_m - share * length_m()}; }
  [[nodiscard]] Span grown(double by_m) const { return {low_m - by_m, high_m + by_m}; }
};

/// One point, and the position where its beam crosses the plane of the face.
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

/// Finds the points whose beam crosses the plane within the spans, and those before or behind that part of it. Without
/// a viewpoint beams count as parallel to the normal. Points farther than `thickness_m` from the plane then count only
/// for themselves (their crossing is NaN).
std::vector<FaceHit> find_hits(std::span<const CloudPoint> cloud, const FaceFrame& face, const Span& across,
                               const Span& up, const std::optional<Point3>& viewpoint, double thickness_m);

enum class EndKind : std::uint8_t {
  kJump,      ///< beams past it reach something behind
  kCrease,    ///< another face of the box begins there
  kStops,     ///< no point was hit past it
  kHidden,    ///< something in front of it, or a surface that it meets, hides it
  kContinues  ///< the plane continues
};

struct FaceEnd {
  double at_m = 0.0;
  double sigma_m = 0.0;
  EndKind kind = EndKind::kStops;
};

/// An end of an axis: sign 1 is the high end.
struct EndPlace {
  FaceAxis axis = FaceAxis::kAcross;
  double sign = 1.0;
  double rough_m = 0.0;     ///< roughness of the face's outermost points
  double sampling_m = 0.0;  ///< spacing of the beams along the axis
  Span beside;              ///< span of the face in the other axis, away from its ends
  /// Position of the scanner, if it is known: along the axis, and in front of the plane.
  std::optional<double> eye_along_m = std::nullopt;
  double eye_before_m = 0.0;
};

/// The end between the beams that hit the face and those that passed it. Each beam near it shows one side of the end; a
/// logistic error of the beams' directions is allowed for. The result is the mean and the standard deviation over all
/// ends and errors, weighted by their likelihood: exact between two beams, and with a large deviation if no beam passed
/// close by.
FaceEnd find_end(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m);

/// A face that begins at an end and extends back from it: x = at + slope * depth.
struct SideFace {
  FaceEnd crease;
  double slope = 0.0;
  double sigma_slope = 0.0;
  double rms_m = 0.0;
  double deepest_m = 0.0;
  std::uint32_t points = 0;
};
/// Finds a side face; empty if too little of it is seen. If the scanner is known, the slope allows for errors along the
/// beams: otherwise the depth errors of the points would turn a side seen at a low angle.
std::optional<SideFace> side_at(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m,
                                double max_depth_m);

}  // namespace gdtslam
