// Requests to end, for example by a signal. After such a request, an interrupted call that waits for another process is
// not repeated. A program sets one check for all its threads. A library leaves the signals to its caller, so it asks
// the caller in the thread that waits.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

namespace gdtslam {

/// The program's check for a request to end; null if it has none. Set it before any thread starts.
inline std::atomic<bool (*)()> asked_to_end = nullptr;

inline bool is_asked_to_end() {
  bool (*const asked)() = asked_to_end;
  return asked != nullptr && asked();
}

/// While this object lives, `wants_end` is called if a signal interrupts a wait of this thread. It is also called from
/// time to time during a wait, because a signal can arrive just before the wait begins. Objects of enclosing scopes are
/// not asked. The call that waited throws what `wants_end` throws.
class AskedAfterSignals {
 public:
  explicit AskedAfterSignals(std::function<bool()> wants_end)
      : wants_end_(std::move(wants_end)), outer_(std::exchange(innermost, this)) {}
  AskedAfterSignals(const AskedAfterSignals&) = delete;
  AskedAfterSignals& operator=(const AskedAfterSignals&) = delete;
  ~AskedAfterSignals() { innermost = outer_; }

  /// Called by a wait after a signal, or if one may have come. Does nothing if this thread has no object of this class.
  static void ask() {
    if (innermost != nullptr && innermost->wants_end_()) innermost->has_ended_ = true;
  }
  /// True if the innermost object ever answered yes; from then on nothing in this thread waits.
  static bool has_ended() { return innermost != nullptr && innermost->has_ended_; }

 private:
  std::function<bool()> wants_end_;
  AskedAfterSignals* outer_;
  bool has_ended_ = false;
  static inline thread_local AskedAfterSignals* innermost = nullptr;
};

}  // namespace gdtslam
