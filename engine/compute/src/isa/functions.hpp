// What a translation unit of one instruction set exports: the kernels as plain functions of pointers. No library
// templates and no inline functions cross this line: the linker keeps one copy of those for the whole program, and a
// copy compiled for AVX-512 must not end up in code that runs elsewhere (a test looks at the objects' symbols).
#pragma once

#include <cstddef>
#include <cstdint>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/compute/kernels/edt.hpp"
#include "gdtslam/compute/kernels/gdt_merge.hpp"
#include "gdtslam/compute/kernels/jump_flood.hpp"
#include "gdtslam/compute/kernels/pose_cost.hpp"
#include "gdtslam/core/elementary.hpp"

namespace gdtslam {

/// The cells of a launch: columns [x_begin, x_end) of rows [y_begin, y_end).
struct CellRange {
  std::uint32_t x_begin;
  std::uint32_t x_end;
  std::uint32_t y_begin;
  std::uint32_t y_end;
};

/// u16 cells of scratch that edt_rows needs.
constexpr std::uint32_t edt_rows_scratch(const EdtRows::Params& params) {
  return params.width + 2 * params.radius + 64;
}
/// u32 cells of scratch that edt_full_rows needs.
constexpr std::uint32_t edt_full_rows_scratch(const EdtFullRows::Params& params) { return 5 * (params.width + 64); }

struct IsaFunctions {
  /// Columns [begin, end).
  void (*edt_columns)(const EdtColumns::Params&, const std::uint8_t* seeds, std::uint8_t* distance, std::uint32_t begin,
                      std::uint32_t end);
  /// Rows [begin, end).
  void (*edt_rows)(const EdtRows::Params&, const std::uint8_t* distance, std::uint16_t* sq_distance,
                   std::uint32_t begin, std::uint32_t end, std::uint16_t* scratch);
  void (*edt_full_columns)(const EdtFullColumns::Params&, const std::uint8_t* seeds, std::uint32_t* distance,
                           std::uint32_t begin, std::uint32_t end);
  void (*edt_full_rows)(const EdtFullRows::Params&, const std::uint32_t* distance, std::uint32_t* sq_distance,
                        std::uint32_t begin, std::uint32_t end, std::uint32_t* scratch);
  void (*distance_field)(const DistanceField::Params&, const std::uint16_t* sq_distance, const std::uint16_t* table,
                         std::uint16_t* field, const CellRange&);
  void (*pose_cost)(const PoseCost::Params&, const std::uint16_t* field, const PointCells* points,
                    const PoseCandidate* candidates, std::uint32_t count, std::uint32_t* cost);
  /// result[0] = cost, result[1] = index; count > 0.
  void (*arg_min)(const std::uint32_t* cost, std::uint32_t count, std::uint32_t* result);
  void (*gdt_merge)(const GdtMerge::Params&, std::uint16_t* global, const std::uint16_t* scan, const CellRange&);
  void (*jump_flood_init)(const JumpFloodInit::Params&, const std::uint8_t* seeds, std::uint32_t* nearest,
                          const CellRange&);
  void (*jump_flood_step)(const JumpFloodStep::Params&, const std::uint32_t* source, std::uint32_t* target,
                          const CellRange&);
  void (*jump_flood_distance)(const JumpFloodDistance::Params&, const std::uint32_t* nearest,
                              std::uint32_t* sq_distance, const CellRange&);
};

extern const IsaFunctions kBaselineFunctions;
#ifdef GDTSLAM_X86_KERNELS
extern const IsaFunctions kAvx2Functions;
extern const IsaFunctions kAvx512Functions;
#endif

/// The functions of an instruction set, or nullptr where the build has none.
constexpr const IsaFunctions* functions_of(Isa isa) {
#ifdef GDTSLAM_X86_KERNELS
  if (isa == Isa::kAvx2) {
    return &kAvx2Functions;
  }
  if (isa == Isa::kAvx512) {
    return &kAvx512Functions;
  }
#endif
  return isa == Isa::kBaseline ? &kBaselineFunctions : nullptr;
}

}  // namespace gdtslam
