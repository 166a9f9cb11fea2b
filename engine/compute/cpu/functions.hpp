// Exports of the translation unit of one instruction set: the kernels as plain functions of pointers. No library
// templates and no inline functions may cross this interface: the linker keeps one copy of those for the whole program,
// and a copy compiled for AVX-512 must not run elsewhere (a test checks the objects' symbols). The small functions
// below are static for that reason.
#pragma once

#include <cstdint>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"
#include "engine/compute/kernels/point_to_line/point_to_line.hpp"
#include "engine/compute/kernels/point_values/point_values.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "engine/core/elementary.hpp"

namespace gdtslam {

/// A list of kernel types.
template <class... K>
struct KernelList {};
/// Every dispatched kernel, in the order of the registry, which walks this list as the cases do.
using AllKernels =
    KernelList<SeedScatter, JumpFloodInit, JumpFloodStep, JumpFloodDistance, DistanceField, PoseCost, GdtMerge,
               FieldGrow, PoseDescent, SweepPoints, PoseBounds, GdtStamp, PointToLine, NdtCost>;

/// The cells of a launch: columns [x_begin, x_end) of rows [y_begin, y_end).
struct CellRange {
  std::uint32_t x_begin;
  std::uint32_t x_end;
  std::uint32_t y_begin;
  std::uint32_t y_end;
};

/// The items of a launch along one dimension: [begin, end).
struct Slice {
  std::uint32_t begin;
  std::uint32_t end;
};

/// After the parameters come the buffers in the order of the bindings, then the range of the launch: the cells of a
/// grid or a slice of its items (columns, rows, samples, cells of a list, starts, candidates, poses, tiles, beams).
struct IsaFunctions {
  void (*distance_field)(const DistanceField::Params&, const std::uint16_t* sq_distance, const std::uint16_t* table,
                         std::uint16_t* field, CellRange);
  void (*pose_cost)(const PoseCost::Params&, const std::uint16_t* field, const PointCells* points,
                    const PoseCandidate* candidates, std::uint32_t* cost, Slice);
  void (*gdt_merge)(const GdtMerge::Params&, std::uint16_t* global, const std::uint16_t* scan, CellRange);
  void (*jump_flood_init)(const JumpFloodInit::Params&, const std::uint8_t* seeds, std::uint32_t* nearest, CellRange);
  void (*jump_flood_step)(const JumpFloodStep::Params&, const std::uint32_t* source, std::uint32_t* target, CellRange);
  void (*jump_flood_distance)(const JumpFloodDistance::Params&, const std::uint32_t* nearest,
                              std::uint16_t* sq_distance, CellRange);
  void (*seed_scatter)(const SeedScatter::Params&, const std::uint32_t* cells, std::uint8_t* seeds, Slice);
  void (*field_grow)(const FieldGrow::Params&, const std::uint16_t* old_field, std::uint16_t* field, CellRange);
  void (*pose_descent)(const PoseDescent::Params&, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint16_t* values, Slice);
  void (*pose_bounds)(const PoseBounds::Params&, const std::uint8_t* field, const BoundPoint* points,
                      const PoseCandidate* tiles, std::uint32_t* sums, Slice);
  void (*sweep_points)(const SweepPoints::Params&, const BeamRange* beams, const BeamStrip* strips, const float* tables,
                       float* points, Slice);
  void (*gdt_stamp)(const GdtStamp::Params&, std::uint16_t* field, const std::uint32_t* list, const std::uint16_t* disc,
                    Slice);
  void (*point_to_line)(const PointToLine::Params&, const float* values, const std::uint16_t* bins,
                        const PointToLine::Pair* pairs, float* sums, Slice);
  void (*ndt_cost)(const NdtCost::Params&, const std::uint32_t* map, const NdtCost::Point* points,
                   const NdtCost::Pose* poses, std::uint32_t* scores, Slice);
  // Only on the host:
  void (*pose_minorant)(const PoseMinorant::Params&, const std::uint16_t* field, const PointCells* points,
                        const PoseCandidate* boxes, std::uint32_t count, PoseMinorant::Value* values);
  void (*field_minorant)(const FieldMinorant::Params&, const std::uint16_t* field, std::uint32_t* minorants);
  void (*pose_minorant_wide)(const PoseMinorantWide::Params&, const std::uint32_t* minorants, const BoundPoint* points,
                             const PoseCandidate* boxes, std::uint32_t count, PoseMinorant::Value* values);
  void (*pose_simplex)(const PoseSimplex::Params&, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, Slice);
  void (*point_values)(const PointValues::Params&, const std::uint16_t* field, const PointCells* points,
                       const PointValues::Pose&, std::uint16_t* values);
  void (*find_lines)(const PointToLine::Params&, const PointToLine::Pose&, const PointToLine::Scan& fixed,
                     const PointToLine::Scan& moving, std::uint32_t every, std::uint32_t taken, std::int32_t* found);
  /// totals: PointToLine::kSums values.
  void (*line_slope)(const PointToLine::Params&, const PointToLine::Pose&, const PointToLine::Scan& fixed,
                     const PointToLine::Scan& moving, std::uint32_t every, std::uint32_t taken,
                     const std::int32_t* found, float* totals);
};

extern const IsaFunctions kBaselineFunctions;
#ifdef GDTSLAM_X86_KERNELS
extern const IsaFunctions kAvx2Functions;
extern const IsaFunctions kAvx512Functions;
#endif

}  // namespace gdtslam
