// Points of a scan that are kept for later use: its returns, and for returns on a surface the surface's normal, from
// the neighbours in beam order. Frame: the robot at the time of the scan; 20 bytes a point on a surface, 8 for any
// other. Thread-safe; linear in the points.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/core/memory/sparing.hpp"
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

/// A return without a known surface.
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
  std::vector<LonePoint> corners{};   ///< lone points that form no line with their neighbours
  [[nodiscard]] std::size_t points() const { return surface.size() + lone.size(); }
  [[nodiscard]] std::size_t bytes() const {
    return surface.size() * sizeof(SurfacePoint) + lone.size() * sizeof(LonePoint);
  }
};

/// All points, those on surfaces first.
std::vector<Point2> to_points(const KeptScan& scan);

/// Grows with the bearing, from -2 to 2 in a full turn, by 0.5 to 1 a radian: it replaces bearings in comparisons, for
/// the price of a division.
inline double pseudo_bearing(double x, double y) {
  const double length = std::fabs(x) + std::fabs(y);
  if (!(length > 0.0)) return 0.0;
  const double share = y / length;
  if (x >= 0.0) return share;
  return y >= 0.0 ? 2.0 - share : -2.0 - share;
}

/// Makes the record of a scan from its points in beam order.
KeptScan keep_scan(std::span<const Point2> points_base_m);

/// Dependence of the points' distances from their surfaces on the pose (tangent x, y, theta): the sum of J^T J over the
/// points, J = (n_x, n_y, p x n) [Censi2007, section III]. An eigenvalue that is small compared with the number of
/// points is a motion that the scan cannot see, for example along a corridor.
Matrix3 surface_shape(const KeptScan& scan);

/// Information about the pose from returns without a known surface: each fixes the pose within a fraction of a metre in
/// both directions. Information of the tangent (x, y, theta), 1/m^2 and so on. Far away in the open, where beams are a
/// foot apart, there is nothing else. If surfaces suffice only corners count, such as posts along a corridor that a
/// beam or two hit.
Matrix3 lone_information(const KeptScan& scan);

/// Information, per point, that normals off by six degrees could feign in a direction in which no surface shows.
inline constexpr double kShapeOfTiltedNormals = 0.01;

/// Information about a translation that the noise of a scan's normals feigns, for one point: its expected value is
/// their variance, and it varies by as much because neighbours share points.
inline double feigned_shape(const KeptScan& scan) { return 2.0 * scan.normal_variance; }

/// True if enough of the scan's surfaces stand across this direction (robot frame, any length) to measure a motion
/// along it: in a bare corridor a match only repeats its prediction.
bool knows_way(const KeptScan& scan, const Point2& direction);

/// Information of one point about the pose, and the share of a motion for which it is reliable.
struct ShapeOfOne {
  Matrix3 shape;
  Matrix3 believed;
};

/// The shape for one point, less `noise`, the information that the noise of the normals feigns about a translation in
/// which no surface shows; at least `least` in any direction.
ShapeOfOne shape_of_one(const Matrix3& shape, std::size_t points, double least, double noise);

/// Writes a scan as a record of a shelf, 8 bytes plus its points, and reads it back.
void put_on(ByteShelf& shelf, const KeptScan& scan);
void take_from(std::span<const std::byte> record, KeptScan& scan);

// A scan's returns with the walls between them. A wall at a grazing angle returns a point every few decimetres. In a
// map of such points alone the next scan fits best if its beams end on the same points again, so a robot in a bare
// corridor seems to stand still. Frame: the robot at the time of the scan. Thread-safe; linear in the points and in the
// length of the walls.

/// The returns in beam order, plus points at most `spacing_m` apart between the middle two of four neighbouring beams
/// that end on one line: an opening there can be no wider than the gap between the beams.
std::vector<Point2> with_surfaces_closed(std::span<const Point2> points_base_m, double spacing_m);

/// The direction (robot frame, of length 1) of the wall at the return with this number, by its neighbours in beam
/// order, if the nearest of them is farther than half a metre; empty for any other return.
std::optional<Point2> lone_on_wall(std::span<const Point2> points_base_m, std::size_t at);

/// The scans of a path by the number of their keyframe. Scans that are not needed any more are dropped one by one and
/// leave eight bytes each, since paths can last for days. Thread-safe while nothing is added or dropped.
class KeptScans {
 public:
  KeptScans() = default;
  ~KeptScans() = default;
  KeptScans(KeptScans&&) = default;
  KeptScans& operator=(KeptScans&&) = default;
  KeptScans(const KeptScans& other) {
    for (const std::unique_ptr<KeptScan>& scan : other.scans_) {
      scans_.push_back(scan ? std::make_unique<KeptScan>(*scan) : nullptr);
    }
  }
  KeptScans& operator=(const KeptScans& other) { return *this = KeptScans(other); }

  void push_back(KeptScan scan) { push_sparingly(scans_, std::make_unique<KeptScan>(std::move(scan))); }
  void forget(std::size_t keyframe) { scans_[keyframe].reset(); }
  /// Keeps the first `count` scans.
  void keep(std::size_t count) { scans_.resize(count); }
  [[nodiscard]] bool has(std::size_t keyframe) const { return scans_[keyframe] != nullptr; }
  /// Scan of a keyframe that was not dropped.
  [[nodiscard]] const KeptScan& operator[](std::size_t keyframe) const { return *scans_[keyframe]; }
  [[nodiscard]] KeptScan& operator[](std::size_t keyframe) { return *scans_[keyframe]; }
  /// Takes all scans that were not dropped, in their order; none are left.
  std::vector<KeptScan> take() {
    std::vector<KeptScan> taken;
    for (const std::unique_ptr<KeptScan>& scan : std::exchange(scans_, {})) {
      if (scan) taken.push_back(std::move(*scan));
    }
    return taken;
  }

 private:
  std::vector<std::unique_ptr<KeptScan>> scans_;
};

/// Read access to scans in either kind of container, which must outlive this.
class ScansOfPath {
 public:
  ScansOfPath() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a view, as std::span is
  ScansOfPath(const KeptScans& kept) : kept_(&kept) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  ScansOfPath(const std::vector<KeptScan>& all) : all_(all) {}
  /// The scan of a keyframe; an empty one if it was dropped.
  [[nodiscard]] const KeptScan& operator[](std::size_t keyframe) const {
    static const KeptScan forgotten;
    if (kept_ == nullptr) return all_[keyframe];
    return kept_->has(keyframe) ? (*kept_)[keyframe] : forgotten;
  }

 private:
  const KeptScans* kept_ = nullptr;
  std::span<const KeptScan> all_;
};

}  // namespace gdtslam
