// Odometry over time by a clock that may fail: a wild stamp, or a clock that is set back while the robot drives. Poses
// are searched only within their stretch of the clock. Frames: robot in the odometry frame. Not thread-safe; keeps
// kMostPoses poses.
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
  /// This many poses in a row that go forward in the past are right; the poses before them are wild or of another
  /// stretch.
  static constexpr std::size_t kSetBack = 5;
  /// A step longer than this, and than kLeapSteps usual steps, is a leap: the next pose decides whether it is right.
  static constexpr double kLeap_s = 1.0;
  static constexpr double kLeapSteps = 5.0;
  /// No interpolation across a gap longer than this and than kLeapSteps usual steps.
  static constexpr double kMostGap_s = 10.0;

  enum class Taken : std::uint8_t {
    kNext,      ///< later than the last
    kRepeated,  ///< same stamp as the previous pose; left out
    kPast,      ///< earlier; left out so far
    kForgot,    ///< the last of kSetBack in the past: fewer poses far ahead were wild and are left out
    kSetBack,   ///< the last of kSetBack in the past: a new stretch begins with the first of them
  };
  Taken take(const Odometry& pose);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// The latest pose of the current stretch.
  [[nodiscard]] const Odometry& back() const { return entries_.back().pose; }
  /// The stretch of the pose taken last, counted from 0.
  [[nodiscard]] std::uint64_t stretch() const { return stretch_; }
  /// At the last kSetBack or kForgot: the last stamp before it, and the first that counts after it.
  [[nodiscard]] double last_before_set_back_s() const { return last_before_s_; }
  [[nodiscard]] double first_after_set_back_s() const { return first_after_s_; }
  /// The median of the last steps; infinite without any.
  [[nodiscard]] double usual_step_s() const;
  [[nodiscard]] bool is_leap(double step_s) const;
  /// True if poses are left out until later ones decide whether they are right.
  [[nodiscard]] bool has_past() const { return !past_.empty(); }
  /// True if the last poses were far in the past: a single one is wild, more of them mean that the clock was set back.
  [[nodiscard]] bool is_in_doubt() const;
  /// True if later poses cannot change the poses around that time.
  [[nodiscard]] bool is_known(std::uint64_t stretch, double stamp_s) const;

  /// The last pose before a time, and the first one at it or after it; null if that stretch has none. Both are the
  /// nearer one if they are too far apart for interpolation.
  struct Around {
    const Odometry* before = nullptr;
    const Odometry* after = nullptr;
  };
  [[nodiscard]] Around around(std::uint64_t stretch, double stamp_s) const;

 private:
  struct Entry {
    Odometry pose;
    std::uint64_t stretch = 0;
    bool leaps = false;  ///< leap from the previous pose
  };
  void append(const Odometry& pose);
  [[nodiscard]] bool forget_wild();

  std::deque<Entry> entries_;   ///< sorted by stretch, then by stamp
  std::vector<Odometry> past_;  ///< the last poses left out in a row, ascending
  std::uint64_t stretch_ = 0;
  double last_before_s_ = 0.0;
  double first_after_s_ = 0.0;
};

}  // namespace gdtslam
