// The mount of a laser out of poses in text. Each pose was rounded by itself, so that the mount between two of them
// jitters from line to line where it is one number. Metres, radians. One object belongs to one laser of one log.
#pragma once

#include <optional>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

inline constexpr double kSameMount = 1e-5;  ///< metres and radians within which two mounts are one

bool is_same_mount(const Pose2& a, const Pose2& b, double tolerance = kSameMount);

class SteadyMount {
 public:
  /// The mount of a line whose poses have so many decimals: rounded to a decimal less, six of them at least, and that
  /// of the lines before as long as it is the same within that.
  Pose2 of(const Pose2& T_base_laser, int decimals);

 private:
  std::optional<Pose2> last_;
};

}  // namespace gdtslam
