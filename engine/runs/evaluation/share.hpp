// A share of trials with its confidence. Thread-safe; O(1).
#pragma once

#include <cstdint>

namespace gdtslam {

/// k of n with the 95 % interval of [Wilson1927].
struct Share {
  std::uint64_t count = 0;
  std::uint64_t of = 0;
  [[nodiscard]] double value() const;
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
};

}  // namespace gdtslam
