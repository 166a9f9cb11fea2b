// A window of candidate poses computed on the device, and its local minima: the first half of the matcher `exhaustive`,
// whose candidates never cross the bus.
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// A prior around a mean pose, as input of kernels. Its cost in float32, without contraction, with dx, dy, dt the pose
/// less the mean: a = (dx*dx + dy*dy) * weight_xy, then a = a < limit ? a : limit; b = (dt*dt) * weight_theta, then b =
/// b < limit ? b : limit; cost = uint32(a + b), rounded towards zero. The limit is at most 1e9, so the sum fits; NaN
/// counts as the limit.
struct PriorParams {
  float mean_x = 0.0F;  ///< finite, as the other means
  float mean_y = 0.0F;
  float mean_theta = 0.0F;
  float weight_xy = 0.0F;     ///< cost units per squared cell, finite, not negative
  float weight_theta = 0.0F;  ///< cost units per squared radian, finite, not negative
  float limit = 1.0e9F;       ///< 0 to 1e9
};

/// The samples of a window, theta outermost, then y, then x: sample (x, y, t) has index (t*count_xy + y)*count_xy + x
/// and coordinate centre + (float(i) - float(count/2)) * step in float32 (count/2 cut), the prior's cost as its bias.
/// Centre and steps are finite, counts at least 1.
/// Bindings: candidates (PoseCandidate, write). Extent: x = count_xy * count_xy * count_theta, at most 2^28.
struct PoseLattice {
  struct Params {
    float centre_x = 0.0F;
    float centre_y = 0.0F;
    float centre_theta = 0.0F;
    float step_cells = 1.0F;
    float step_rad = 0.01F;
    std::uint32_t count_xy = 1;
    std::uint32_t count_theta = 1;
    PriorParams prior{};
  };
  static constexpr std::array kBindings{Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// Cost of a cell that is no local minimum, and of missing entries if fewer were found than wanted.
inline constexpr std::uint32_t kNoCost = 0xFFFFFFFFU;

/// Keeps the cost of a sample that no neighbour (up to 26, one step in any direction) beats, by (cost, index); kNoCost
/// for the others. Bindings: cost (u32, read), minima (u32, write). Extent: x = number of samples.
struct LatticeMinima {
  struct Params {
    std::uint32_t count_xy = 1;
    std::uint32_t count_theta = 1;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

/// The `wanted` smallest values by (value, index), ascending; kNoCost is no value, and both words of a missing entry
/// are kNoCost. Bindings: values (u32, read), picks (pairs of u32: value, index; write). Extent: x = 1; wanted 1 to 16.
struct SmallestValues {
  struct Params {
    std::uint32_t count = 0;
    std::uint32_t wanted = 1;
  };
  static constexpr std::uint32_t kMost = 16;
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

}  // namespace gdtslam
