// Whether somebody was asked to end, as by a signal: calls that wait for another process are not made again then. A
// program says so for all its threads; a library, whose signals are its caller's, asks him in the thread that waits.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

namespace gdtslam {

/// Nobody asks unless the program says how that is told. To be set before there are threads.
inline std::atomic<bool (*)()> asked_to_end = nullptr;

inline bool is_asked_to_end() {
  bool (*const asked)() = asked_to_end;
  return asked != nullptr && asked();
}

/// While it lives, `wants_end` is asked where a signal interrupted a wait of this thread, and now and then while one
/// lasts, for a signal may come just before it; those of the objects around it are not. What it throws comes out of the
/// call that waited.
class AskedAfterSignals {
 public:
  explicit AskedAfterSignals(std::function<bool()> wants_end)
      : wants_end_(std::move(wants_end)), outer_(std::exchange(innermost, this)) {}
  AskedAfterSignals(const AskedAfterSignals&) = delete;
  AskedAfterSignals& operator=(const AskedAfterSignals&) = delete;
  ~AskedAfterSignals() { innermost = outer_; }

  /// For calls that wait: a signal came, or may have come. Nobody is asked where there is no object in this thread.
  static void ask() {
    if (innermost != nullptr && innermost->wants_end_()) innermost->has_ended_ = true;
  }
  /// Whether the answer was ever yes: from then on nothing in this thread waits.
  static bool has_ended() { return innermost != nullptr && innermost->has_ended_; }

 private:
  std::function<bool()> wants_end_;
  AskedAfterSignals* outer_;
  bool has_ended_ = false;
  static inline thread_local AskedAfterSignals* innermost = nullptr;
};

}  // namespace gdtslam
