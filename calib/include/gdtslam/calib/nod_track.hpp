// The crank's (or the elevation's) course over time from a log's messages: unwrapped, checked, linear between two
// messages, never extrapolated. Each fault of an encoder has one stated outcome:
//   wrap at the index mark: unwrapped, no remark;
//   runs backwards: used as measured, counted;
//   jumps (faster than max_turns_per_s): the time between the two messages is not covered, counted;
//   messages missing (a gap longer than max_gap_s): not covered, counted;
//   stands still while messages come: used as measured;
//   ends: nothing is covered after its last message;
//   stamps that go backwards: messages in the past are dropped, counted.
// One track belongs to one thread. Memory: only what forget_before() left.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam::calib {

struct NodTrackLimits {
  double max_gap_s = 0.25;
  double max_turns_per_s = 5.0;
};

class NodTrack {
 public:
  NodTrack(const CrankEncoder& encoder, const NodTrackLimits& limits);
  /// For TILT messages: phases are those of ElevationTable::identity().
  explicit NodTrack(const NodTrackLimits& limits);

  void take(const Encoder& message);
  void take(const Tilt& message);
  /// No scan that ends before this will ever be covered better than it is now.
  [[nodiscard]] std::optional<double> known_until_s() const;
  /// Knots from `from_s` to `to_s` (at least two; the ends interpolated), offsets relative to `stamp_s`; empty where
  /// the stretch is not covered as a whole.
  [[nodiscard]] std::vector<PhaseKnot> knots(double stamp_s, double from_s, double to_s) const;
  void forget_before(double stamp_s);

  struct Faults {
    std::uint64_t backwards = 0;
    std::uint64_t jumps = 0;
    std::uint64_t gaps = 0;
    std::uint64_t past_stamps = 0;
    std::uint64_t wraps = 0;
    [[nodiscard]] std::vector<LogReader::Warning> as_warnings() const;
  };
  [[nodiscard]] const Faults& faults() const { return faults_; }

 private:
  struct Message {
    double stamp_s = 0.0;
    double turns = 0.0;     ///< unwrapped, from tick 0
    bool is_joined = true;  ///< to the message before: the time between is covered
  };
  void append(double stamp_s, double turns);

  NodTrackLimits limits_;
  CrankEncoder encoder_;
  std::deque<Message> messages_;
  Faults faults_;
};

}  // namespace gdtslam::calib
