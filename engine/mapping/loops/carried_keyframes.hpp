// Keyframes that follow the places of a graph. Thread-safe; linear in the keyframes.
#pragma once

#include <cstddef>
#include <span>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Writes the poses of the keyframes from the first place on: between two places the path keeps its shape, and what the
/// graph moved its end by is spread over it. `places` are keyframes, ascending, of which those that have a pose in
/// `of_places` count; shape and poses have one entry a keyframe.
void carry_keyframes_between(std::span<const std::size_t> places, std::span<const Pose2> of_places,
                             std::span<const Pose2> shape, std::span<Pose2> poses);

}  // namespace gdtslam
