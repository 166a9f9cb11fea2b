// Direct calls of the CPU kernels, for host code that works sequentially on a field in the host's memory and cannot
// afford a dispatch: the same functions that the CPU backend runs, on the caller's thread, without
// checks of sizes (asserts only). Parameters, layouts and arithmetic are those of kernels/*.hpp. Grids need no padding:
// nothing outside [0, width) of a row is read or written. Thread-safe.
#pragma once

#include <cstdint>
#include <span>

#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"
#include "engine/compute/kernels/point_to_line/point_to_line.hpp"
#include "engine/compute/kernels/point_values/point_values.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

/// Costs of `count` candidates; field height and width at least 2, at most 65,537 points.
void pose_cost_host(Isa isa, const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points,
                    const PoseCandidate* candidates, std::uint32_t count, std::uint32_t* cost);

/// A descent from each of `count` poses, in place; field height and width at least 2, at most 65,537 points.
void pose_simplex_host(Isa isa, const PoseSimplex::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint32_t count);

/// A descent along the slope from each of `count` poses, in place, and the field under the points at its end; field
/// height and width at least 2.
void pose_descent_host(Isa isa, const PoseDescent::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint16_t* values, std::uint32_t count);

/// The field under each point at a pose; field height and width at least 1.
void point_values_host(Isa isa, const PointValues::Params& params, const std::uint16_t* field, const PointCells* points,
                       const PointValues::Pose& pose, std::uint16_t* values);

/// The line of each of the points taken from a scan, or PointToLine::kNone.
void find_lines_host(Isa isa, const PointToLine::Params& params, const PointToLine::Pose& pose,
                     const PointToLine::Scan& fixed, const PointToLine::Scan& moving, std::uint32_t every,
                     std::span<std::int32_t> found);
/// Normal equations of these points on the lines found.
PointToLine::Sums line_slope_host(Isa isa, const PointToLine::Params& params, const PointToLine::Pose& pose,
                                  const PointToLine::Scan& fixed, const PointToLine::Scan& moving, std::uint32_t every,
                                  std::span<const std::int32_t> found);

/// Scores of poses of a cloud in a map of make_ndt_map(), one score a pose.
void ndt_cost_host(Isa isa, const NdtCost::Params& params, std::span<const std::uint32_t> map,
                   std::span<const NdtCost::Point> points, std::span<const NdtCost::Pose> poses,
                   std::span<std::uint32_t> scores);

/// Sums of `count` tiles of boxes, tile_width * tile_height each.
void pose_bounds_host(Isa isa, const PoseBounds::Params& params, const std::uint8_t* field, const BoundPoint* points,
                      const PoseCandidate* tiles, std::uint32_t count, std::uint32_t* sums);

/// Minorants of `count` boxes; field height and width at least 4.
void pose_minorant_host(Isa isa, const PoseMinorant::Params& params, const std::uint16_t* field,
                        const PointCells* points, const PoseCandidate* boxes, std::uint32_t count,
                        PoseMinorant::Value* values);

/// Minorants of a field, (width + 2 * kMargin) * (height + 2 * kMargin) words; reach 1 to 3.
void field_minorant_host(Isa isa, const FieldMinorant::Params& params, const std::uint16_t* field,
                         std::uint32_t* minorants);

/// Minorants of `count` boxes from such fields.
void pose_minorant_wide_host(Isa isa, const PoseMinorantWide::Params& params, const std::uint32_t* minorants,
                             const BoundPoint* points, const PoseCandidate* boxes, std::uint32_t count,
                             PoseMinorant::Value* values);

}  // namespace gdtslam
