// The plainest programs that are right, one for each kernel: what the fast ones are held against. They share no code
// with engine/compute but the types of the parameters; cost is no concern.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/point_values/point_values.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam::test {

/// A grid's shape.
struct GridShape {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t stride = 0;
};

/// Squared distance of every cell to every seed, the least of them; kNoSeed where there is no seed. Paper equation (1).
std::vector<std::uint32_t> brute_sq_distances(const std::vector<std::uint8_t>& seeds, const GridShape& shape);

/// The same for one cell.
std::uint32_t brute_sq_distance(const std::vector<std::uint8_t>& seeds, const GridShape& shape, std::uint32_t x,
                                std::uint32_t y);

/// The merged value of one cell, line by line as docs/paper.md has equations (9) to (11).
std::uint16_t brute_merge(const GdtMerge::Params& params, std::uint16_t global, std::uint16_t scan);

/// Cost of one candidate, in wide integers.
std::uint32_t brute_pose_cost(const PoseCost::Params& params, const std::vector<std::uint16_t>& field,
                              const std::vector<PointCells>& points, const PoseCandidate& candidate);

/// The field under each point at a pose, as point_values.hpp describes it.
std::vector<std::uint16_t> brute_point_values(const PointValues::Params& params,
                                              const std::vector<std::uint16_t>& field,
                                              const std::vector<PointCells>& points, const PointValues::Pose& pose);

/// Squared distances as kernels give them: at most the squared radius.
std::vector<std::uint16_t> truncated(const std::vector<std::uint32_t>& sq_distances, std::uint32_t radius);

/// Jump flooding with coordinates instead of packed indices: squared distances that are found
/// with these steps.
std::vector<std::uint32_t> brute_jump_flood(const std::vector<std::uint32_t>& steps,
                                            const std::vector<std::uint8_t>& seeds, const GridShape& shape);

/// What a dispatch of the case list must leave in its buffers, padding as it was. Throws std::logic_error for a kernel
/// that has no oracle.
CaseOutcome brute_outcome(const KernelCase& kernel_case);

}  // namespace gdtslam::test
