// Warnings of several readers as one list, counted by kind.
#pragma once

#include <algorithm>
#include <vector>

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

}  // namespace gdtslam
