// Clouds in a country's grid are read relative to whole kilometres; who prints or draws places says so.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>

#include "console.hpp"

namespace gdtslam {

inline std::string origin_text(const std::string& cloud, const std::array<double, 3>& origin_m) {
  return fmt::format("{} lies far from its origin: places are relative to ({:.0f}, {:.0f}, {:.0f}) m", cloud,
                     origin_m[0], origin_m[1], origin_m[2]);
}

/// One line on standard error where something was taken off.
inline void remark_origin(const std::string& cloud, const std::array<double, 3>& origin_m) {
  if (origin_m != std::array<double, 3>{}) print_remark(origin_text(cloud, origin_m));
}

}  // namespace gdtslam
