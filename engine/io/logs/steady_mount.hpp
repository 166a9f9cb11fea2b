// The mount of a laser from poses in text. Each pose was rounded alone, so a constant mount between two of them jitters
// from line to line. Metres, radians. One object belongs to one laser of one log.
#pragma once

#include <optional>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

inline constexpr double kSameMount = 1e-5;  ///< metres and radians within which two mounts are equal

bool is_same_mount(const Pose2& a, const Pose2& b, double tolerance = kSameMount);

class SteadyMount {
 public:
  /// The mount of a line whose poses have `decimals` (at least six), rounded to one decimal less. The mount of earlier
  /// lines is kept while the new one equals it within that rounding.
  Pose2 of(const Pose2& T_base_laser, int decimals);

 private:
  std::optional<Pose2> last_;
};

}  // namespace gdtslam
