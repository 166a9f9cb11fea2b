// Boxes of poses for the tests of certified matching: affine minorants of the cost in them, held against the cost of
// poses drawn from them.
#pragma once

#include <functional>
#include <span>

#include "certified_fields.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam::test {

/// A scene with the centre of its boxes, in cells from the anchor.
struct Scene : FieldScene {
  CellIndex anchor;
  PoseCandidate centre;
  float slack = 0.0025F;  ///< cells: 1/512, and float32 within 300 cells
};

struct BoxSize {
  float half_width;
  float half_angle;
};

/// A pose of a box of the scene, often at an edge of it.
CellPose drawn_pose(const Scene& scene, const BoxSize& size, Random& random);

PoseMinorant::Params minorant_params(const Scene& scene, const BoxSize& size);
/// The minorant of a box by patches.
PoseMinorant::Value patch_minorant(const Scene& scene, const BoxSize& size);
/// And by fields of minorants, for all points at one reach.
PoseMinorant::Value wide_minorant(const Scene& scene, const BoxSize& size, std::uint32_t reach);

using MinorantOf = std::function<PoseMinorant::Value(const Scene&, const BoxSize&)>;
/// Expects that no pose drawn from the boxes costs less than their minorants say; the mean of what these lie below the
/// cost by, a point.
double checked_margin(const Scene& scene, std::uint64_t seed, std::span<const BoxSize> sizes,
                      const MinorantOf& minorant_of);

}  // namespace gdtslam::test
