// Normal equations of a scan's points on the lines of another scan: each point is paired with the nearest surface point
// in about the same direction, whose normal makes it a line [Censi2008]. Metres and radians.
//
// Arithmetic (docs/numerics.md), float32 without contraction, the same bits on every instruction set and device; values
// are finite, and their products neither infinite nor subnormal. reciprocal() is that of pose_descent.hpp.
//
// * Point j of those taken is number j * every of the moving scan. A pose puts it at
//   X = (cos px - sin py) + x, Y = (sin px + cos py) + y.
// * At `found` its direction is share = Y * reciprocal(|X| + |Y|), for a sum up to 1e-18 Y * reciprocal(1).
//   If X < 0 the direction is 2 - share instead, and -2 - share if Y < 0 as well.
// * Its bin is (direction + 2) * 64, held between 0 and 255, rounded down. The candidates are kCandidates
//   lines from kBefore before the first one of that bin, held within the scan.
// * A candidate's key is the bits of its squared distance dx dx + dy dy, the lowest four replaced by its
//   number among the candidates. The least key is the point's line if it is below the bits of gate_m2 and
//   low <= direction <= high.
// * At `at`, with (nx, ny) the normal of the line and (lx, ly) its place:
//   off = nx (X - lx) + ny (Y - ly), jx = cos nx + sin ny, jy = cos ny - sin nx, jt = px jy - py jx.
// * The weight w is the square of reciprocal(1 + (off off) per_kernel_m2), the kernel of Geman and McClure.
//   It is 0 unless jx mx + jy my is at least least_cosine, (mx, my) being the point's own normal.
// * The terms are (w jx) jx, (w jx) jy, (w jx) jt, (w jy) jy, (w jy) jt, (w jt) jt, (w off) jx, (w off) jy,
//   (w off) jt, w, (w off) off. Those of point j are added to lane j % kLanes; lane i + k is added to lane i
//   until one is left, k = kLanes / 2, ..., 1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// Equations of many pairs of scans. Bindings: values (f32, read), bins (u16, read), pairs (Pair, read), sums (f32 in
/// rows of kSums, write). Extent: x = pairs. The blocks that a pair names lie within the buffers.
struct PointToLine {
  static constexpr std::uint32_t kLanes = 32;
  static constexpr std::uint32_t kCandidates = 16;
  static constexpr std::int32_t kBefore = 6;
  static constexpr std::uint32_t kBins = 256;  ///< bins of pseudo_bearing(), -2 to 2
  static constexpr std::int32_t kNone = -1;    ///< the point is on no line
  struct Params {
    float gate_m2 = 0.0225F;
    float per_kernel_m2 = 493.8F;  ///< 1 / square of the scale of the kernel of Geman and McClure
    float least_cosine = 0.8F;     ///< between the normals of a point and of its line
  };
  /// The moving scan in the frame of the fixed one.
  struct Pose {
    float x = 0.0F;
    float y = 0.0F;
    float sin = 0.0F;
    float cos = 1.0F;
  };
  /// A scan laid on another. A scan's block of values holds the x of all its points, then all y, then the normals' x
  /// and y; the points are in the order of their directions, padded with points far away to kCandidates.
  struct Pair {
    Pose found;         ///< at which the lines are found
    Pose at;            ///< of the equations
    float low = -2.0F;  ///< directions that the fixed scan sees
    float high = 2.0F;
    std::uint32_t fixed = 0;        ///< first value of its block
    std::uint32_t fixed_count = 0;  ///< its points, with the padding
    std::uint32_t bins = 0;         ///< its first bin, even: each holds the first point in it or after it
    std::uint32_t moving = 0;
    std::uint32_t moving_count = 0;
    std::uint32_t every = 1;  ///< stride through the points
    std::uint32_t taken = 0;  ///< number of points taken
  };
  /// A scan on the host.
  struct Scan {
    const float* values = nullptr;
    std::uint32_t count = 0;
    const std::uint16_t* bins = nullptr;
    float low = -2.0F;
    float high = 2.0F;
  };
  /// Sums over the points, each by its weight: information xx, xy, xt, yy, yt, tt and gradient x, y, t for motions on
  /// the right of the pose; the weights; the squared distances from the lines.
  static constexpr std::size_t kSums = 11;
  using Sums = std::array<float, kSums>;
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam
