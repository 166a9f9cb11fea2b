// Scores of poses of a cloud in a map of normal distributions [BiberStrasser2003], in space [Magnusson2009]. The map is
// a box of cubes, each with or without a distribution. Units are metres; a pose puts the cloud into the map's frame.
//
// Arithmetic (docs/numerics.md), float32 without contraction, the same bits on every instruction set and device.
//
// * A pose moves point p to X = ((rx px + ry py) + rz pz) + (t - origin) along each axis, (rx, ry, rz) being the axis'
//   row of the rotation and t its translation. X counts from the origin of the box.
// * Its cube along the axis is floor(X * cubes_per_m + 1) - 1. The sum is clamped to 0 to 2^30 before, and NaN counts
//   as 0, which is outside of the box. A device may take -1e-40 for 0; the 1 puts both into the same cube.
// * A point scores 0 if it is outside of the box, or if its cube's number is not below distribution_count.
// * With (dx, dy, dz) the differences of X from the mean, the squared Mahalanobis distance is
//   q = (u dx + v dy) + (zz dz) dz, u = xx dx + (a + a), a = xy dy + xz dz, v = yy dy + (b + b), b = yz dz.
// * The point scores entry q * steps_per_unit of the table, rounded down. Before, the product is clamped to 0 to 255,
//   and NaN counts as 255. An entry is at most 4095 and the last one 0, so 2^20 points do not overflow a sum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// Bindings: map (u32 words, make_ndt_map(), read), points (Point, read), poses (Pose, read), scores (u32, write).
/// Extent: x = poses, at most 2^20.
struct NdtCost {
  static constexpr std::uint32_t kSteps = 256;  ///< entries of the table
  static constexpr std::uint32_t kMostPoints = 1U << 20U;
  static constexpr std::uint32_t kMostPoses = 1U << 20U;
  static constexpr std::uint32_t kMostScore = 4095;  ///< of a point
  static constexpr std::int32_t kNone = -1;          ///< a cube without a distribution
  struct Params {
    std::uint32_t point_count = 0;
    std::uint32_t size_x = 0;  ///< of the box, cubes: at most 65,536, and 2^28 in all
    std::uint32_t size_y = 0;
    std::uint32_t size_z = 0;
    std::uint32_t distribution_count = 0;  ///< at most 2^24
    float origin_x_m = 0.0F;               ///< lower corner of the box
    float origin_y_m = 0.0F;
    float origin_z_m = 0.0F;
    float cubes_per_m = 1.0F;     ///< above 0, at most 1e6
    float steps_per_unit = 8.0F;  ///< steps of the table per unit of q; above 0, at most 1e6
  };
  struct Point {
    float x = 0.0F;
    float y = 0.0F;
    float z = 0.0F;
  };
  struct Pose {
    float rotation[9] = {1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F};  ///< row by row
    float translation_m[3] = {};
  };
  /// The information is the inverse of the covariance, 1/m^2. Its entries are at most 1e15 in magnitude.
  struct Distribution {
    float mean_x = 0.0F;  ///< from the origin of the box, where floats are finer than far away
    float mean_y = 0.0F;
    float mean_z = 0.0F;
    float xx = 0.0F;
    float xy = 0.0F;
    float xz = 0.0F;
    float yy = 0.0F;
    float yz = 0.0F;
    float zz = 0.0F;
    float unused[3] = {};
  };
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// The words of a map: the table, the distributions, and for each cube the number of its distribution or
/// NdtCost::kNone. Cube (x, y, z) is number (z * size_y + y) * size_x + x. Throws Error if an entry of the table is
/// above kMostScore, or the last one is not 0.
std::vector<std::uint32_t> make_ndt_map(std::span<const std::uint32_t, NdtCost::kSteps> table,
                                        std::span<const NdtCost::Distribution> distributions,
                                        std::span<const std::int32_t> cubes);

}  // namespace gdtslam
