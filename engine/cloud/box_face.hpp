// The plane of a box's face as a frame, and the points of a cloud as that face sees them. Metres.
#pragma once

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
  double across_m = 0.0;  ///< of the crossing
  double up_m = 0.0;
  double depth_m = 0.0;         ///< of the point behind the plane
  double point_across_m = 0.0;  ///< of the point itself
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

/// Of the points whose beam crosses the plane within the spans, or that lie before or behind that part of it. Without a
/// viewpoint beams are taken to run along the normal, and points farther than `thickness_m` from the plane count for
/// themselves only (their crossing is not a number).
std::vector<FaceHit> hits_of(std::span<const CloudPoint> cloud, const FaceFrame& face, const Span& across,
                             const Span& up, const std::optional<Point3>& viewpoint, double thickness_m);

}  // namespace gdtslam
