// Relations that constrain keyframes while their scans are adjusted together: the measured path, and the loops that
// closed it. Frame: none, relations only. Thread-safe; linear in the keyframes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/loops/measured_path.hpp"

namespace gdtslam {

/// Index of a keyframe in `kept`, which is ascending; empty if it is not there.
std::optional<std::size_t> number_in(std::span<const std::size_t> kept, std::size_t keyframe);

/// Relations between successive kept keyframes, by the wheels and by the front end with their weights, and the front
/// end's relations over stretches of its local map in which all keyframes are kept. `kept` are keyframes, ascending;
/// relations refer to indices in it.
std::vector<PoseRelation> held_path(const MeasuredPath& measured, std::span<const std::size_t> kept);

/// The active loops, with their weights, between kept keyframes: two passes may be too far apart for their points to
/// constrain each other. `places` are the keyframes of the graph's nodes.
std::vector<PoseRelation> held_loops(const PoseGraph& graph, std::span<const std::size_t> places,
                                     std::span<const std::size_t> kept);

}  // namespace gdtslam
