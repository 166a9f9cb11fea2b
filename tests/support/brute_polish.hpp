// The plainest program for pose_simplex.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"

namespace gdtslam::test {

/// What a descent did, and how often.
struct BruteMoves {
  std::uint32_t expansions = 0;   ///< kept
  std::uint32_t overshoots = 0;   ///< expansions that were no better than the reflection
  std::uint32_t reflections = 0;  ///< kept, of medium cost
  std::uint32_t outside = 0;      ///< contractions towards the reflection, kept
  std::uint32_t inside = 0;       ///< contractions towards the worst vertex, kept
  std::uint32_t shrinks = 0;
};

/// One descent of [Nelder1965] as PoseSimplex describes it; adds its moves to `moves` where that is given.
PolishedPose brute_descent(const PoseSimplex::Params& params, const std::vector<std::uint16_t>& field,
                           const std::vector<PointCells>& points, const PolishedPose& start,
                           BruteMoves* moves = nullptr);

}  // namespace gdtslam::test
