// The plainest programs for the kernels of pose_lattice.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"

namespace gdtslam::test {

/// The samples of a window, each operation rounded to float32 by itself, from exact ones in double.
std::vector<PoseCandidate> brute_lattice(const PoseLattice::Params& params);

/// The prior's cost of a pose.
std::uint32_t brute_prior_cost(const PriorParams& prior, float x, float y, float theta);

/// Costs of the samples that none of the neighbours beats, looked at one by one.
std::vector<std::uint32_t> brute_minima(const LatticeMinima::Params& params, const std::vector<std::uint32_t>& costs);

/// Pairs (value, index) of the smallest values, by sorting all of them.
std::vector<std::uint32_t> brute_smallest(const std::vector<std::uint32_t>& values, std::uint32_t wanted);

}  // namespace gdtslam::test
