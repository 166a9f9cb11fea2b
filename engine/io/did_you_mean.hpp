// "Did you mean": the known name that a misspelt one resembles most. Thread-safe; O(names x length^2).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// The nearest of the names, the first of equals; none if more than a third of the letters differ. The part after the
/// last dot is also compared on its own, so "resolution" finds "map.resolution".
std::optional<std::string_view> nearest_name(std::string_view name, std::span<const std::string_view> names);

/// "; did you mean 'name'?" with the nearest of the names, or empty if none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

}  // namespace gdtslam
