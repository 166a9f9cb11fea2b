// Boxes of a cloud and their dimensions with uncertainty, as figure 12 measures them. Metres, frame of the cloud, z up.
//
// A range finder errs along its beams, hardly across them. So where the scanner stood still and its place is known,
// every point is moved along its beam onto the plane of a face: what is hit there and what is seen past it tell where
// the face ends, to a fraction of the distance between two beams. Where two faces meet, the edge is where their planes
// do. Without a viewpoint only the points of the face itself count.
//
// Cost: that of find_planes and one pass over the cloud for each face. Thread-safe; the same cloud and search give the
// same boxes on every host.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gdtslam/cloud/plane.hpp"

namespace gdtslam {

/// A length with its standard deviation.
struct Dimension {
  double value_m = 0.0;
  double sigma_m = 0.0;      ///< infinite where nothing was seen of it
  bool is_observed = false;  ///< both of its ends were seen
};

/// An upright box that stands on the floor (or on whatever its lower side is).
struct MeasuredBox {
  Point3 centre{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;  ///< heading of the width's direction, in (-pi/2, pi/2]
  Dimension width;       ///< along the face that is seen best
  Dimension depth;       ///< 0 and infinitely uncertain where no other face is seen
  Dimension height;
  std::uint32_t points = 0;           ///< number of points of the face
  double face_rms_m = 0.0;            ///< RMS of their distances from its plane
  Point3 face_normal{1.0, 0.0, 0.0};  ///< outwards
};

/// Limits for boxes, and how their faces are found.
struct BoxSearch {
  PlaneSearch planes{.min_points = 50, .gap_m = 0.1};
  double max_size_m = 1.5;  ///< larger things are walls or furniture
  double min_size_m = 0.1;
  std::uint32_t min_face_points = 50;
  double max_tilt_rad = 0.1;        ///< tilt of a face from upright
  std::optional<Point3> viewpoint;  ///< position of the scanner, when it stood still
  bool is_projection = false;       ///< faces as lines of the projection to the floor, as figure 12(c) has them
};
/// Position of the scanner, from the elevation of every point: all points of one elevation lie in one plane through it.
/// Empty when the scanner moved, when the elevations say too little or are not there. The points do not show its
/// position along the axis of the nodding: it is taken to be that of the map's origin.
std::optional<Point3> standing_viewpoint(std::span<const CloudPoint> cloud);

/// The widest first.
std::vector<MeasuredBox> find_boxes(std::span<const CloudPoint> cloud, const BoxSearch& search);

}  // namespace gdtslam
