// Point-to-line scan matching [Censi2008]: the normal equations that align the surface points of one scan with those of
// another. Each point is paired with the nearest point in about the same direction. Thread-safe. Cost of each point
// taken: some five nanoseconds to find its line, two to add it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compute/kernels/point_to_line/point_to_line.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Which points count, and how much.
struct LineGate {
  double most_m = 0.15;     ///< gate: points farther from their line do not count; it also scales the robust kernel
  std::size_t points = 90;  ///< approximate number of points taken from the moving scan
};

/// Normal equations for a motion of the moving scan: right perturbation, in the frame of that scan.
struct LineEquations {
  Matrix3 information;  ///< per square metre of point noise
  Tangent2 gradient{};
  double weight = 0.0;  ///< sum of the weights of the points that count
  double cost_m2 = 0.0;
};

/// The surface points of a scan, as points and as lines for those of others: 16 bytes a point, and half a kilobyte. A
/// point beyond the field of view is on no line: the line of the last beam has its normal from one side alone, tilted
/// by that beam's own noise. Points beyond it would pull scans onto each other, by 0.1 per cent of the way along a
/// corridor.
class LineScan {
 public:
  LineScan() : LineScan(std::span<const SurfacePoint>{}) {}
  explicit LineScan(std::span<const SurfacePoint> surface);
  explicit LineScan(const KeptScan& scan) : LineScan(scan.surface) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] PointToLine::Scan view() const;
  /// The block of values and the bins, as the kernel has them.
  [[nodiscard]] std::span<const float> values() const { return values_; }
  [[nodiscard]] std::span<const std::uint16_t> bins() const { return bins_; }

 private:
  std::size_t size_;
  std::vector<float> values_;
  std::array<std::uint16_t, PointToLine::kBins> bins_{};
  float low_ = -2.0F;
  float high_ = 2.0F;
};

/// Which points of a scan are taken: every so many, and how many that are.
struct TakenShare {
  TakenShare(std::size_t size, std::size_t wanted);
  std::uint32_t every;
  std::uint32_t count;
};

PointToLine::Params line_params(const LineGate& gate);
PointToLine::Pose line_pose(const Pose2& T_fixed_moving);
LineEquations to_equations(const PointToLine::Sums& sums);

/// Builds the equations at T_fixed_moving.
LineEquations line_equations(const LineScan& fixed, const LineScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate);

}  // namespace gdtslam
