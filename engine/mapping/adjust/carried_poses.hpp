// Poses that follow others which were adjusted. Thread-safe.
#pragma once

#include <span>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Moves each of `poses` as the nearest of `before` moved to `after`, which have one entry each; farther than 4 m from
/// all of them it stays. Linear in the poses and in those around each.
void carry_with_nearest(std::span<const Pose2> before, std::span<const Pose2> after, std::span<Pose2> poses);

}  // namespace gdtslam
