// Distance field cells: uint16, 1/256 cell, rounded to nearest from the squared distance by a table that the host
// computes once with integer square roots; the cap 256*R stands for "nothing within R" and for unknown.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

inline constexpr std::uint32_t kFieldOne = 256;  ///< one cell

/// Value of unknown cells for a truncation radius in cells.
constexpr std::uint16_t field_cap(std::uint32_t radius) { return static_cast<std::uint16_t>(radius * kFieldOne); }

/// round(256*sqrt(d2)) for d2 = 0 .. R*R, by integer arithmetic.
std::vector<std::uint16_t> distance_table(std::uint32_t radius);

/// Bindings: squared distance (u16, read), table (u16, read, R*R+1 entries), field (u16, write). Squared distances
/// beyond the table read its last entry. Extent: x = width, y = rows.
struct DistanceField {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t table_size = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam
