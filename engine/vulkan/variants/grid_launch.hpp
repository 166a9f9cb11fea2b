// Work groups of the kernels that treat a grid.
#pragma once

#include <algorithm>
#include <cstdint>

#include "variants.hpp"

namespace gdtslam {

constexpr std::uint32_t divided_up(std::uint32_t count, std::uint32_t part) {
  return static_cast<std::uint32_t>((std::uint64_t{count} + part - 1) / part);
}

/// Groups of a grid launch: along x they cover `columns` things, along y `rows` rows, `rows_each` an invocation. A
/// shader goes on by the launch's rows where that leaves some (launch_rows() in shaders/common/launch.glsl), so any
/// number of rows is covered.
constexpr GroupCount grid_groups(std::uint32_t columns, std::uint32_t group_columns, std::uint32_t rows,
                                 std::uint32_t rows_each) {
  constexpr std::uint32_t kMostGroups = 65535;
  return {divided_up(columns, group_columns), std::min(divided_up(rows, rows_each), kMostGroups), 1};
}

}  // namespace gdtslam
