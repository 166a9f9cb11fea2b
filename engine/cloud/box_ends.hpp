// Where a face ends, from what its beams hit on it and past it. Metres along one axis of the face.
#pragma once

#include <optional>
#include <span>

#include "box_face.hpp"

namespace gdtslam {

enum class EndKind : std::uint8_t {
  kJump,      ///< beams past it go on to something behind
  kCrease,    ///< another face of the box begins there
  kStops,     ///< nothing was hit past it
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
  double rough_m = 0.0;     ///< of the face's outermost points
  double sampling_m = 0.0;  ///< from beam to beam along the axis
  Span beside;              ///< of the face in the other axis, away from its ends
  /// Of the scanner, where it is known: along the axis, and before the plane.
  std::optional<double> eye_along_m = std::nullopt;
  double eye_before_m = 0.0;
};

/// The end between the beams that hit the face and those that passed it. Each beam near it says on which side of the
/// end it went by; a logistic error of the beams' directions is allowed for. The answer is the mean and the standard
/// deviation over all ends and errors, as likely as they explain the beams: exact between two beams, and honest where
/// no beam went close by.
FaceEnd end_of(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m);

/// A face that begins at an end and goes back from it: x = at + slope * depth.
struct SideFace {
  FaceEnd crease;
  double slope = 0.0;
  double sigma_slope = 0.0;
  double rms_m = 0.0;
  double deepest_m = 0.0;
  std::uint32_t points = 0;
};
/// Nothing where too little of it is seen. Where the scanner is known, the slope is that for errors along the beams: a
/// side seen at a low angle would else be turned by the errors of its points' depths.
std::optional<SideFace> side_at(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m,
                                double max_depth_m);

}  // namespace gdtslam
