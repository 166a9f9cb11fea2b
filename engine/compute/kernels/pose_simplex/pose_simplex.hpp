// The second half of the matcher `exhaustive`: simplexes from several start poses at once, and the choice between their
// results. The simplex is that of [Nelder1965] on the cost of pose_cost.hpp plus the prior of pose_lattice.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// A pose during its descent. Coordinates as in PoseCandidate.
struct PolishedPose {
  float x = 0.0F;
  float y = 0.0F;
  float theta = 0.0F;
  std::uint32_t cost = 0;         ///< at the pose, prior included
  std::uint32_t evaluations = 0;  ///< poses costed so far, over all passes, modulo 2^32
  std::uint32_t stop = 0;         ///< reason for stopping in the last pass: 0 not run, 1 converged, 2 evaluation limit
  std::uint32_t reserved[2] = {0, 0};
};

/// Start 0 is the pose of the parameters; start i is the candidate of pick i-1, or start 0 if that pick's index is not
/// below `candidate_count`. All other members are 0. Bindings: candidates (PoseCandidate, read), picks (pairs of u32
/// value, index; read), poses (PolishedPose, write). Extent: x = starts, at most SmallestValues::kMost + 1.
struct PoseStarts {
  struct Params {
    float x = 0.0F;
    float y = 0.0F;
    float theta = 0.0F;
    std::uint32_t candidate_count = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// One descent from each pose, in place. The walk, in float32 without contraction: first simplex: the pose and steps
/// along x, y, theta from it, costed in that order, sorted by cost (stable). Until the largest |x_i - x_0|, |y_i - y_0|
/// is below stop_cells and the largest |theta_i - theta_0| below stop_rad, or the evaluations of this descent have
/// reached max_evaluations (tested before each move): centre = (v0 + v1 + v2) * (1/3) per coordinate, summed left to
/// right; point at f = centre + f * (v3 - centre); reflect (f -1); if its cost is below v0's expand (f -2) and keep the
/// expansion if strictly better, else the reflection; else if below v2's keep the reflection; else contract (f -1/2 if
/// the reflection is strictly better than v3, else +1/2) and keep it if strictly below the lesser of the reflection's
/// and v3's cost; else shrink v1..v3 to v0 + 1/2 * (v_i - v0), costed in that order. After each move sort (stable). The
/// cost of a pose is PoseCost's sum plus the prior's cost, saturating. The size is tested before the limit: a small
/// simplex has converged. Differences that are NaN do not count in it (x_i - x_0 is NaN if a start is not finite; such
/// a pose is costed like any other, and the NaN at its end is unspecified). The result is v0 and its cost; evaluations
/// grow by those of this descent. Bindings: field (u16, read), points (PointCells, read), poses (PolishedPose, read and
/// write). Extent: x = poses.
struct PoseSimplex {
  struct Params {
    PoseCost::Params cost;
    PriorParams prior;
    float step_cells = 2.0F;   ///< edge of the first simplex along x and y
    float step_rad = 0.03F;    ///< and along theta
    float stop_cells = 0.01F;  ///< stops when the simplex is smaller than this in x and y ...
    float stop_rad = 0.0002F;  ///< ... and than this in theta
    std::uint32_t max_evaluations = 200;
  };
  /// Largest max_evaluations: if coordinates are so large that they cannot come close, only this ends a descent. Some
  /// devices also end loops by themselves after 65,535 iterations.
  static constexpr std::uint32_t kMostEvaluations = 8192;
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kReadWrite};
  static const KernelInfo& info();
};

/// Result of a scan for the host: the chosen pose and the evidence for it, in integers.
struct MatchVerdict {
  float x = 0.0F;
  float y = 0.0F;
  float theta = 0.0F;
  std::uint32_t cost = 0;         ///< cost of the voters, prior and penalty included
  std::uint32_t chosen = 0;       ///< index of the pose
  std::uint32_t evaluations = 0;  ///< evaluations of all poses together
  std::uint32_t stop = 0;         ///< reason for stopping of the chosen one
  std::uint32_t sum = 0;          ///< sum of min(value, wide) over all points, nearest cell, 1/256 cell
  std::uint32_t near = 0;         ///< points with value <= gate
  std::uint32_t beside = 0;       ///< points with 2 * gate < value < cap
  std::uint32_t known = 0;        ///< points with value < cap
  std::uint32_t voters = 0;
  std::uint32_t local_cost = 0;  ///< cost of pose 0, like `cost`
};
static_assert(sizeof(MatchVerdict) <= 64);

/// Chooses between poses. The value of a point at a pose is the field at the nearest cell as in PoseCost, before any
/// cap. At pose 0 near, beside and known are counted; pose 0 is suspect if beside * 65536 > contradiction_q16 * known
/// or near * 65536 < overlap_q16 * points. The voters are all points if pose 0 is suspect, else the points whose value
/// at pose 0 is below min(wide, cap of the map). A pose costs PoseCost's sum over the voters with cap `wide` plus the
/// prior's cost, saturating. If leap_q8 is not 0 and pose 0 is not far from the prior's mean but another pose is, the
/// other costs (cost * leap_q8) >> 8, at most 2^32 - 1; far: dx*dx + dy*dy > far_sq_cells or |dt| > far_rad in float32.
/// The lowest (cost, index) is chosen, and the evidence is counted there. Bindings: field (u16, read), points
/// (PointCells, read), poses (PolishedPose, read), verdict (MatchVerdict, write). Extent: x = 1. At most 65535 points
/// and SmallestValues::kMost + 1 poses; map_cap and gate at most 65535, the shares at most 65536 (all points).
struct ChoosePose {
  struct Params {
    PoseCost::Params cost;  ///< its cap is `wide`
    PriorParams prior;
    std::uint32_t pose_count = 1;
    std::uint32_t map_cap = 0;  ///< value of unknown cells
    std::uint32_t gate = 0;     ///< 1/256 cell
    std::uint32_t contradiction_q16 = 65536;
    std::uint32_t overlap_q16 = 0;
    std::uint32_t leap_q8 = 0;
    float far_sq_cells = 0.0F;
    float far_rad = 0.0F;
  };
  static constexpr std::uint32_t kMostPoints = 65535;
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam
