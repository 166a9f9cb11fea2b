// Corrections of a planar path to poses in space. Each knot, half a second after the last, has a shift u and a turn w
// (rotation vector) of the robot about its place in the plane; both are linear in time between knots. The elevation has
// knots of its own. Frame: map, metres, radians. Thread-safe while it is constant.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/stream.hpp"
#include "surfels.hpp"

namespace gdtslam {

/// A planar path with the strokes of the mount, and a point of the axis that the laser nods about.
struct PlanarPath {
  Trajectory poses;              ///< one a scan
  std::uint32_t first_scan = 0;  ///< number of the first pose's scan
  Point3 axis_base_m = Point3::Zero();
  std::vector<Stroke> strokes{};  ///< in log order; none: all is one rising stroke
};

class PathCorrection {
 public:
  /// Knots of the elevation for rising strokes, then as many for falling ones: a fault of the linkage depends on the
  /// crank.
  static constexpr std::size_t kKnotsOfAStroke = 24;
  static constexpr std::size_t kElevationKnots = 2 * kKnotsOfAStroke;

  /// All corrections are 0 at first. Elevations lie between the two given. `path` must not be empty.
  PathCorrection(PlanarPath path, double lowest_rad, double highest_rad);

  /// The robot in the plane at one moment, and the knots around it: `share` is 0 at knot, 1 at knot + 1.
  struct Moment {
    Point3 centre = Point3::Zero();
    Point3 left = Point3::Zero();  ///< unit vector
    Point3 axis = Point3::Zero();  ///< a point of the nodding axis, which is parallel to left
    std::size_t knot = 0;
    double share = 0.0;
    bool is_upward = true;  ///< the stroke
  };
  /// The moment of a scan's stamp; between two scans its number is a fraction.
  [[nodiscard]] Moment at_scan(double scan) const;
  /// Knots of the elevation around one elevation.
  struct ElevationPlace {
    std::size_t knot = 0;
    double share = 0.0;
  };
  [[nodiscard]] ElevationPlace at_elevation(double elevation_rad, bool is_upward) const;

  /// Correction at a moment: u, w.
  [[nodiscard]] Tangent3 correction(const Moment& moment) const;
  /// Where a point lies that was measured at that moment and elevation.
  [[nodiscard]] Point3 corrected(const Point3& point, double elevation_rad, const Moment& moment) const;
  /// Corrects points, which are in log order.
  void correct(std::span<CloudPoint> points) const;
  /// T_map_base of each scan.
  [[nodiscard]] std::vector<Pose3> poses() const;

  [[nodiscard]] const PlanarPath& path() const { return path_; }
  /// Seconds from knot to knot + 1.
  [[nodiscard]] double step_s(std::size_t knot) const { return knot_s_[knot + 1] - knot_s_[knot]; }
  /// The moment of a knot.
  [[nodiscard]] const Moment& knot_moment(std::size_t knot) const { return moments_[knot]; }

  std::vector<Tangent3> knots;              ///< u, w at each; at least two
  std::vector<double> elevation_knots_rad;  ///< added to the elevation

 private:
  /// Two scans of the path around a moment; `share` is 0 at the first.
  struct Between {
    std::size_t before = 0;
    std::size_t after = 0;
    double share = 0.0;
  };
  [[nodiscard]] Between scans_around(double scan) const;
  [[nodiscard]] Moment planar_moment(const Between& scans) const;
  [[nodiscard]] double lift_rad(double elevation_rad, const Moment& moment) const;

  PlanarPath path_;
  double lowest_rad_;
  double elevation_step_rad_;
  std::vector<double> scan_s_;  // seconds since the first scan, gaps of the clock left out
  std::vector<double> knot_s_;
  std::vector<Moment> moments_;
};

}  // namespace gdtslam
