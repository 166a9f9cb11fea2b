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
  double sigma_centre_m = 0.0;        ///< standard deviation of the plane where the points' centre is
  double sigma_offset_m = 0.0;        ///< standard deviation of the offset, the direction's part included
  double sigma_normal_rad = 0.0;      ///< standard deviation of the direction, the worse of the two
  Point3 centre{0.0, 0.0, 0.0};
};

/// Limits for planes, and how long one is looked for.
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
/// The same; nothing for fewer than three points and for points on one line as far as floats can tell.
std::optional<PlanePatch> fitted_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points);
/// The largest planes in turn, by area, each the connected patch that has most of it. Trials [Fischler1981] are made on
/// a thinned copy whose points have normals [Schnabel2007], one point for each; their number falls with the share of
/// the plane that was found. What a patch was found by is refined on all points of the cloud; points beside an edge,
/// where another surface begins, belong to the patch but do not pull at its plane. Points that are not finite are left
/// out. The same cloud and seed give the same planes on every host. O(trials x cells) for each plane and O(n log n)
/// once.
std::vector<PlanePatch> find_planes(std::span<const CloudPoint> cloud, const PlaneSearch& search);

}  // namespace gdtslam
