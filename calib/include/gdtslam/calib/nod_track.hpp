// The crank's (or the elevation's) course over time from a log's messages: unwrapped, checked, linear between two
// messages, never extrapolated. Each fault of an encoder has one stated outcome:
//   wraps at the index mark, in either direction: unwrapped, counted, no remark (between two messages the crank must
//     turn less than half a turn, else the direction is unknown);
//   runs backwards: used as measured, counted;
//   jumps (faster than max_turns_per_s): the time between the two messages is not covered, counted;
//   messages missing (a gap longer than max_gap_s): not covered, counted;
//   stands still while messages come: used as measured;
//   ends: nothing is covered after its last message;
//   stamps that repeat, go backwards or are not finite: the message is dropped, counted. If kSetBack dropped ones in a
//     row ascend, the clock was set back (or one stamp far ahead was wrong): the track restarts with the first of them;
//   an elevation that is not finite: the message is dropped, counted as a jump.
// One track belongs to one thread. Memory: messages that forget_before() kept. take() is O(1), knots() logarithmic in
// these plus linear in its result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam::calib {

/// Larger gaps are not covered; faster turns are faults of the encoder.
struct NodTrackLimits {
  double max_gap_s = 0.25;
  double max_turns_per_s = 5.0;
};

/// The course over time; pass messages in the order of the log.
class NodTrack {
 public:
  NodTrack(const CrankEncoder& encoder, const NodTrackLimits& limits);
  /// For TILT messages: phases are those of ElevationTable::identity().
  explicit NodTrack(const NodTrackLimits& limits);

  void take(const Encoder& message);
  void take(const Tilt& message);
  static constexpr std::size_t kSetBack = 5;
  /// True if a message with this stamp restarts the track, which then forgets everything.
  [[nodiscard]] bool begins_again_at(double stamp_s) const;
  /// Scans that end before this time cannot be covered any better later.
  [[nodiscard]] std::optional<double> known_until_s() const;
  /// Knots from `from_s` to `to_s` in the log's clock: at least two, the ends interpolated, less than half a turn
  /// apart, offsets relative to `stamp_s`. If from_s is to_s, two equal ones. Empty if the range is not covered as a
  /// whole.
  [[nodiscard]] std::vector<PhaseKnot> knots(double stamp_s, double from_s, double to_s) const;
  /// Frees messages needed only for earlier times, which may not be covered afterwards.
  void forget_before(double stamp_s);
  [[nodiscard]] std::size_t kept_messages() const { return messages_.size(); }

  /// Number of faults of one kind, and the stamp of the message that showed the first.
  struct Count {
    std::uint64_t count = 0;
    double first_stamp_s = 0.0;
    void add(double stamp_s);
  };
  struct Faults {
    Count backwards;
    Count jumps;
    Count gaps;
    Count past_stamps;
    Count wraps;
    /// Warnings of the faults that occurred; a wrap is no fault.
    [[nodiscard]] std::vector<LogReader::Warning> as_warnings() const;
  };
  [[nodiscard]] const Faults& faults() const { return faults_; }

 private:
  struct Message {
    double stamp_s = 0.0;
    double turns = 0.0;     ///< unwrapped, from tick 0
    bool is_joined = true;  ///< the time since the previous message is covered
  };
  void append(double stamp_s, double measured_turns);
  void note_past(double stamp_s, double measured_turns);
  [[nodiscard]] bool joins_last(double stamp_s, double turned);
  [[nodiscard]] double turns_at(std::size_t before, double stamp_s) const;

  NodTrackLimits limits_;
  CrankEncoder encoder_;
  bool is_crank_ = true;                     ///< else the elevation itself, which has no forward direction
  double resolution_ = 0.0;                  ///< turns per tick
  double last_turns_ = 0.0;                  ///< measured turns of the last message kept
  std::optional<std::int64_t> first_ticks_;  ///< origin of the turns; with an index mark those of the last message
  std::deque<Message> messages_;
  std::vector<Message> past_;  ///< last consecutive dropped messages with ascending stamps; turns as measured
  Faults faults_;
};

}  // namespace gdtslam::calib
