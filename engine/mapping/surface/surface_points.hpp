// Points kept of a scan for everything that looks back: its returns, and for those that lie on a surface the surface's
// normal, from the neighbours in beam order. Frame: the robot when it was scanned; 20 bytes a point on a surface, 8
// another. Thread-safe; linear in the points.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A return on a surface.
struct SurfacePoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float normal_x = 0.0F;  ///< unit length, toward the robot
  float normal_y = 0.0F;
  float direction = 0.0F;  ///< pseudo_bearing() the point

  [[nodiscard]] Point2 point() const { return {x_m, y_m}; }
  [[nodiscard]] Point2 normal() const { return {normal_x, normal_y}; }
};

/// A return of which no surface is known.
struct LonePoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  [[nodiscard]] Point2 point() const { return {x_m, y_m}; }
};

/// The returns of one scan.
struct KeptScan {
  std::vector<SurfacePoint> surface;  ///< by direction, ascending
  std::vector<LonePoint> lone;        ///< in beam order
  double normal_variance = 0.0;       ///< mean over the surface points, rad^2
  std::vector<LonePoint> corners{};   ///< lone points that are on no line with their neighbours
  [[nodiscard]] std::size_t points() const { return surface.size() + lone.size(); }
  [[nodiscard]] std::size_t bytes() const {
    return surface.size() * sizeof(SurfacePoint) + lone.size() * sizeof(LonePoint);
  }
};

/// All of them, those on surfaces first.
std::vector<Point2> to_points(const KeptScan& scan);

/// Grows with the bearing, from -2 to 2 once around, by 0.5 to 1 a radian: what bearings are compared for, for the
/// price of a division.
inline double pseudo_bearing(double x, double y) {
  const double length = std::fabs(x) + std::fabs(y);
  if (!(length > 0.0)) return 0.0;
  const double share = y / length;
  if (x >= 0.0) return share;
  return y >= 0.0 ? 2.0 - share : -2.0 - share;
}

/// `points_base_m` in beam order.
KeptScan keep_scan(std::span<const Point2> points_base_m);

/// How the distance of the points from their surfaces changes with the pose (tangent x, y, theta): the sum of J^T J
/// over the points, J = (n_x, n_y, p x n) [Censi2007, section III]. An eigenvalue that is small beside the number of
/// points is a motion that the scan cannot see, as along a corridor.
Matrix3 surface_shape(const KeptScan& scan);

/// Information about the pose from returns without a known surface: each fixes the pose within a metre's fraction in
/// both directions. Information of the tangent (x, y, theta), 1/m^2 and so on. Far away in the open, where beams are a
/// foot apart, there is nothing else. If surfaces suffice only corners count, such as posts along a corridor that a
/// beam or two hit.
Matrix3 lone_information(const KeptScan& scan);

/// Information, per point, that normals off by six degrees could pretend to give in a direction in which nothing is to
/// be seen.
inline constexpr double kShapeOfTiltedNormals = 0.01;

/// The noise of a scan's normals feigns a translation, for one point: their variance is its expected value, and
/// neighbours that share points make it vary by as much.
inline double feigned_shape(const KeptScan& scan) { return 2.0 * scan.normal_variance; }

/// Whether enough of the scan's surfaces stand across this direction (robot frame, any length) to tell how far the
/// robot went along it: in a bare corridor a match says what its prediction said.
bool knows_way(const KeptScan& scan, const Point2& direction);

/// Information of one point on the pose, and the share of a motion that the point is to be believed of.
struct ShapeOfOne {
  Matrix3 shape;
  Matrix3 believed;
};

/// The shape for one point, less what the noise of the normals feigns of a translation along which there is nothing to
/// be seen, `noise`; and `least` in any direction.
ShapeOfOne shape_of_one(const Matrix3& shape, std::size_t points, double least, double noise);

/// Writes a scan as a record of a shelf, 8 bytes and those of its points, and reads it back.
void put_on(ByteShelf& shelf, const KeptScan& scan);
void take_from(std::span<const std::byte> record, KeptScan& scan);

}  // namespace gdtslam
