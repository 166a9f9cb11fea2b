// When to stop looking far and wide: a laser that is covered, or one that gives noise, matches nothing, and as nobody
// knows how far the robot went meanwhile each of its scans would be searched for in the widest window. Thread-safe as a
// number is; constant time.
#pragma once

#include <cstdint>

namespace gdtslam {

class Patience {
 public:
  /// Scans one after the other that match nothing, after which only each so-manieth is searched for. Of nine real logs
  /// none has more than five in a row.
  static constexpr std::uint64_t kScans = 64;
  static constexpr std::uint64_t kSearchedThen = 8;

  /// A scan with enough points to be matched: whether it was.
  void take(bool is_accepted) { refused_ = is_accepted ? 0 : refused_ + 1; }
  /// Whether the next one is to be looked for near its prediction alone.
  [[nodiscard]] bool is_over() const { return refused_ >= kScans && refused_ % kSearchedThen != 0; }

 private:
  std::uint64_t refused_ = 0;
};

}  // namespace gdtslam
