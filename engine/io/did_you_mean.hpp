// A hint for a misspelt word of the command line. Thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nearest_name.hpp"

namespace gdtslam {

/// "; did you mean 'name'?" with the nearest of the names, or nothing when none resembles.
inline std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  const auto nearest = nearest_name(word, views);
  return nearest ? "; did you mean '" + std::string(*nearest) + "'?" : "";
}

}  // namespace gdtslam
