// The warnings of a reader. One counter belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Warnings counted by kind, in the order of the first of each kind. The number of kinds is bounded, so that a hostile
/// file cannot make the list grow.
class WarningCounter {
 public:
  /// Keeps `first` only for the first warning of a kind; if it is expensive, call add_to() before.
  void add(std::string_view kind, const std::string& first, std::uint64_t count = 1) {
    if (!add_to(kind, count)) {
      const bool full = list_.size() >= kMaxKinds;
      if (full && add_to(kOtherKinds, count)) {
        return;
      }
      list_.push_back({std::string(full ? kOtherKinds : kind), count, first});
    }
  }
  /// Counts a known kind; false for a new one.
  bool add_to(std::string_view kind, std::uint64_t count = 1) {
    for (LogReader::Warning& warning : list_) {
      if (warning.kind == kind) {
        warning.count += count;
        return true;
      }
    }
    return false;
  }
  [[nodiscard]] const std::vector<LogReader::Warning>& list() const { return list_; }

 private:
  static constexpr std::size_t kMaxKinds = 64;
  static constexpr std::string_view kOtherKinds = "other kinds";
  std::vector<LogReader::Warning> list_;
};

}  // namespace gdtslam
