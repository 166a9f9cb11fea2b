// The plainest program for the kernel of sweep_points.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/compute/kernels/sweep_points/sweep_points.hpp"

namespace gdtslam::test {

/// x, y, z, elevation.
using SweptPoint = std::array<float, 4>;

/// What a launch reads.
struct SweepInput {
  SweepPoints::Params params;
  std::vector<BeamRange> beams;
  std::vector<BeamStrip> strips;
  std::vector<float> tables;
};

/// One beam, each operation rounded to float32 by itself, from an exact one in double; integers in 64 bits with
/// divisions.
SweptPoint brute_sweep_point(const SweepInput& input, std::uint32_t beam);

}  // namespace gdtslam::test
