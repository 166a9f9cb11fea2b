// Planes of a cloud: robust search and exact fit with its uncertainty. Metres, frame of the cloud.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// Points x with normal . x = offset; the normal has length 1.
struct Plane {
  Point3 normal{0.0, 0.0, 1.0};
  double offset_m = 0.0;
  [[nodiscard]] double distance_m(const Point3& point) const {
    return normal.x() * point.x() + normal.y() * point.y() + normal.z() * point.z() - offset_m;
  }
};

/// A plane with the points that lie on it.
struct PlanePatch {
  Plane plane;
  std::vector<std::uint32_t> points;  ///< indices into the cloud, ascending
  double rms_m = 0.0;                 ///< RMS of the points' distances
  double sigma_centre_m = 0.0;        ///< standard deviation of the plane at the points' centre
  double sigma_offset_m = 0.0;        ///< standard deviation of the offset, the direction's part included
  double sigma_normal_rad = 0.0;      ///< standard deviation of the direction, the worse of the two
  Point3 centre{0.0, 0.0, 0.0};
};

/// Limits for planes and for their search.
struct PlaneSearch {
  double thickness_m = 0.03;  ///< a point farther away is not on the plane
  std::uint32_t min_points = 200;
  std::uint32_t max_planes = 32;
  double gap_m = 0.25;          ///< points of one patch have a neighbour this close
  std::uint32_t trials = 2000;  ///< at most, for each plane
  std::uint64_t seed = 1;
};

/// Least squares: the plane that minimises the summed squared distance. Throws InputError for fewer than three points
/// and for points on one line.
PlanePatch fit_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points);
/// The same, but empty for fewer than three points and for points on one line within float precision.
std::optional<PlanePatch> fitted_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points);
/// The largest planes in turn, by area, each the connected patch with most of its area. Trials [Fischler1981] run on a
/// thinned copy whose points have normals [Schnabel2007], one point for each; their number falls with the share of the
/// plane found. The plane of each patch is refined on all points of the cloud. Points near an edge to another surface
/// belong to the patch but do not influence its plane. Points that are not finite are left out. The same cloud and seed
/// give the same planes on every host. O(trials x cells) for each plane and O(n log n) once.
std::vector<PlanePatch> find_planes(std::span<const CloudPoint> cloud, const PlaneSearch& search);

// Boxes of a cloud and their dimensions with uncertainty, as figure 12 measures them; z up.
//
// A range finder errs along its beams, hardly across them. So if the scanner stood still and its position is known,
// every point is moved along its beam onto the plane of a face. Hits on the face and beams that pass it show its end to
// a fraction of the distance between two beams. At an edge of two faces their planes meet. Without a viewpoint only the
// points of the face itself count.
//
// Cost: that of find_planes and one pass over the cloud for each face. Thread-safe; the same cloud and search give the
// same boxes on every host.

/// A length with its standard deviation.
struct Dimension {
  double value_m = 0.0;
  double sigma_m = 0.0;      ///< infinite if nothing was seen of it
  bool is_observed = false;  ///< both of its ends were seen
};

/// An upright box that stands on the floor, or on its lower side.
struct MeasuredBox {
  Point3 centre{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;  ///< heading of the width's direction, in (-pi/2, pi/2]
  Dimension width;       ///< along the face that is seen best
  Dimension depth;       ///< 0 and infinitely uncertain if no other face is seen
  Dimension height;
  std::uint32_t points = 0;           ///< number of points of the face
  double face_rms_m = 0.0;            ///< RMS of their distances from its plane
  Point3 face_normal{1.0, 0.0, 0.0};  ///< outwards
};

/// Limits for boxes and for the search of their faces.
struct BoxSearch {
  PlaneSearch planes{.min_points = 50, .gap_m = 0.1};
  double max_size_m = 1.5;  ///< larger things are walls or furniture
  double min_size_m = 0.1;
  std::uint32_t min_face_points = 50;
  double max_tilt_rad = 0.1;        ///< tilt of a face from upright
  std::optional<Point3> viewpoint;  ///< position of the scanner, when it stood still
  bool is_projection = false;       ///< faces as lines of the projection to the floor, as in figure 12(c)
};
/// Position of the scanner, from the elevation of every point: all points of one elevation lie in one plane through it.
/// Empty if the scanner moved, or if the elevations are missing or not sufficient. The points do not determine its
/// position along the axis of the nodding: that of the map's origin is assumed.
std::optional<Point3> standing_viewpoint(std::span<const CloudPoint> cloud);

/// Finds the boxes, the widest first.
std::vector<MeasuredBox> find_boxes(std::span<const CloudPoint> cloud, const BoxSearch& search);

}  // namespace gdtslam
