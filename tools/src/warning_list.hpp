// Warnings of several readers as one list, counted by kind.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "console.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Adds the counts; of a kind that the list has, its own first example stays.
inline void merge_warnings(std::vector<LogReader::Warning>& list, const std::vector<LogReader::Warning>& more) {
  for (const LogReader::Warning& warning : more) {
    const auto same =
        std::find_if(list.begin(), list.end(), [&warning](const auto& known) { return known.kind == warning.kind; });
    if (same == list.end()) {
      list.push_back(warning);
    } else {
      same->count += warning.count;
    }
  }
}

/// Each on a line of its own, on standard error.
inline void print_warnings(const std::vector<LogReader::Warning>& warnings) {
  for (const LogReader::Warning& warning : warnings) {
    print_remark(fmt::format("warning: {} ({} times; first: {})", warning.kind, warning.count, warning.first));
  }
}

}  // namespace gdtslam
