// Odometry over time by a clock that may fail: a stamp that is wild, or a clock that is set back while the robot drives
// on. Poses of a stretch of the clock are found among those of that stretch only. Frames: robot in the odometry frame.
// Not thread-safe; kMostPoses poses are kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class OdometryTrack {
 public:
  static constexpr std::size_t kMostPoses = 4096;
  /// So many poses in a row that go forward in the past are right, and what was before is not, or of another stretch.
  static constexpr std::size_t kSetBack = 5;
  /// A step longer than this, and than kLeapSteps usual steps, is a leap: the next pose says whether it is true.
  static constexpr double kLeap_s = 1.0;
  static constexpr double kLeapSteps = 5.0;
  /// Across what is longer than this, and than kLeapSteps usual steps, nothing is interpolated.
  static constexpr double kMostGap_s = 10.0;

  enum class Taken : std::uint8_t {
    kNext,      ///< later than the last
    kRepeated,  ///< has the stamp of the one before it, and is left out
    kPast,      ///< earlier, and left out so far
    kForgot,    ///< the last of kSetBack in the past: poses far ahead, fewer than those, were wild and are left out
    kSetBack,   ///< the same: a new stretch begins with the first of them
  };
  Taken take(const Odometry& pose);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// The latest pose of the stretch in hand.
  [[nodiscard]] const Odometry& back() const { return entries_.back().pose; }
  /// The stretch of the pose taken last, counted from 0.
  [[nodiscard]] std::uint64_t stretch() const { return stretch_; }
  /// When it last set back or forgot: the last stamp until then, and the first that counts from then on.
  [[nodiscard]] double last_before_set_back_s() const { return last_before_s_; }
  [[nodiscard]] double first_after_set_back_s() const { return first_after_s_; }
  /// The median of the last steps; infinite as long as there are none.
  [[nodiscard]] double usual_step_s() const;
  [[nodiscard]] bool is_leap(double step_s) const;
  /// Whether poses are left out of which the next ones tell whether they are right.
  [[nodiscard]] bool has_past() const { return !past_.empty(); }
  /// Whether the last poses were far in the past: a single one is wild, more of them are a clock that was set back.
  [[nodiscard]] bool is_in_doubt() const;
  /// Whether later poses cannot change what is around that time.
  [[nodiscard]] bool is_known(std::uint64_t stretch, double stamp_s) const;

  /// The last pose before a time, and the first one at it or after it; none: there is none in that stretch. Both are
  /// the nearer one where they are too far apart to say what is between them.
  struct Around {
    const Odometry* before = nullptr;
    const Odometry* after = nullptr;
  };
  [[nodiscard]] Around around(std::uint64_t stretch, double stamp_s) const;

 private:
  struct Entry {
    Odometry pose;
    std::uint64_t stretch = 0;
    bool leaps = false;  ///< from the one before it
  };
  void append(const Odometry& pose);
  [[nodiscard]] bool forget_wild();

  std::deque<Entry> entries_;   ///< in the order of their stretches, and of their stamps within
  std::vector<Odometry> past_;  ///< the last ones that were left out, in a row, forward among themselves
  std::uint64_t stretch_ = 0;
  double last_before_s_ = 0.0;
  double first_after_s_ = 0.0;
};

}  // namespace gdtslam
