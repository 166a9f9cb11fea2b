// What a log tells of the mount that nods its laser: the messages of the crank, or of the elevation, and what is odd
// about them, seen without a linkage. Memory does not grow. One check belongs to one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

struct NodCheck {
  std::uint64_t encoder_records = 0;
  std::uint64_t tilt_records = 0;
  double mean_rate_hz = 0.0;      ///< of the kind that there is more of
  double longest_gap_s = 0.0;     ///< between two messages
  double longest_gap_at_s = 0.0;  ///< stamp of the message before it
  std::uint64_t backward_stamps = 0;
  std::uint64_t still_steps = 0;  ///< messages that repeat the value of the one before
  std::uint64_t reversals = 0;    ///< of the direction in which the ticks count, falls at the index mark left out
  std::int64_t lowest_ticks = 0;
  std::int64_t highest_ticks = 0;
  std::uint64_t falls = 0;  ///< steps down by more than half of the ticks' range: a counter that starts again
  double lowest_tilt_rad = 0.0;
  double highest_tilt_rad = 0.0;

  [[nodiscard]] bool has_records() const { return encoder_records + tilt_records > 0; }
  /// What the user may want to know or do, a sentence each.
  [[nodiscard]] std::vector<std::string> suggestions() const;
};

class NodChecker {
 public:
  void add(const Encoder& message);
  void add(const Tilt& message);
  [[nodiscard]] NodCheck finish() const;

 private:
  void add_time(double stamp_s);
  void add_step(double step);

  NodCheck check_;
  std::optional<Encoder> last_encoder_;
  std::optional<double> last_tilt_rad_;
  std::optional<double> first_s_;
  double last_s_ = 0.0;
  int direction_ = 0;
};

}  // namespace gdtslam
