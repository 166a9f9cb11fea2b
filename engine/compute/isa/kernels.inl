// All kernels, compiled once per instruction set: the including file defines GDTSLAM_ISA_LEVEL (0 baseline, 1 AVX2,
// 2 AVX-512) and GDTSLAM_ISA_FUNCTIONS, the name of the table it exports. Everything else stays in an anonymous
// namespace.
#include "engine/compute/cpu/functions.hpp"

#if GDTSLAM_ISA_LEVEL > 0
#include <immintrin.h>
#endif

namespace gdtslam {
namespace {

// Own minimum and maximum: those of the library are templates (cpu/functions.hpp).
constexpr std::uint8_t lesser(std::uint8_t a, std::uint8_t b) { return a < b ? a : b; }
constexpr std::uint16_t lesser(std::uint16_t a, std::uint16_t b) { return a < b ? a : b; }
constexpr std::uint32_t lesser(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
constexpr std::uint32_t greater(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }
constexpr std::uint16_t greater(std::uint16_t a, std::uint16_t b) { return a > b ? a : b; }
constexpr std::int32_t clamped(std::int32_t value, std::int32_t low, std::int32_t high) {
  const std::int32_t raised = value < low ? low : value;
  return raised > high ? high : raised;
}
constexpr std::uint8_t u8(std::uint32_t value) { return static_cast<std::uint8_t>(value); }
constexpr std::uint16_t u16(std::uint32_t value) { return static_cast<std::uint16_t>(value); }
constexpr std::uint32_t u32(std::uint16_t value) { return value; }
constexpr std::size_t at(std::uint32_t stride, std::uint32_t y) { return static_cast<std::size_t>(stride) * y; }

// clang-format off
#if GDTSLAM_ISA_LEVEL == 2
#include "lanes_avx512.inl"
#elif GDTSLAM_ISA_LEVEL == 1
#include "lanes_avx2.inl"
#endif
#include "engine/compute/kernels/distance_field/distance_field.inl"
#include "engine/compute/kernels/pose_cost/pose_cost.inl"
#include "engine/compute/kernels/gdt_merge/gdt_merge.inl"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.inl"
#include "engine/compute/kernels/jump_flood/jump_flood.inl"
#include "engine/compute/kernels/ndt_cost/ndt_cost.inl"
#include "engine/compute/kernels/pose_bounds/pose_bounds.inl"
#include "engine/compute/kernels/pose_bounds/pose_minorant.inl"
#include "engine/compute/kernels/pose_bounds/pose_minorant_wide.inl"
#include "engine/compute/kernels/pose_bounds/field_minorant.inl"
#include "engine/compute/kernels/point_values/point_values.inl"
#include "engine/compute/kernels/pose_descent/pose_descent.inl"
#include "engine/compute/kernels/pose_simplex/pose_simplex.inl"
#include "engine/compute/kernels/point_to_line/point_to_line.inl"
#include "engine/compute/kernels/sweep_points/sweep_points.inl"
// clang-format on

}  // namespace

const IsaFunctions GDTSLAM_ISA_FUNCTIONS = {
    .distance_field = distance_field,
    .pose_cost = pose_cost,
    .gdt_merge = gdt_merge,
    .jump_flood_init = jump_flood_init,
    .jump_flood_step = jump_flood_step,
    .jump_flood_distance = jump_flood_distance,
    .seed_scatter = seed_scatter,
    .field_grow = field_grow,
    .pose_descent = pose_descent,
    .pose_bounds = pose_bounds,
    .sweep_points = sweep_points,
    .gdt_stamp = gdt_stamp,
    .point_to_line = point_to_line,
    .ndt_cost = ndt_cost,
    .pose_minorant = pose_minorant,
    .field_minorant = field_minorant,
    .pose_minorant_wide = pose_minorant_wide,
    .pose_simplex = pose_simplex,
    .point_values = point_values,
    .find_lines = find_lines,
    .line_slope = line_slope,
};

}  // namespace gdtslam
