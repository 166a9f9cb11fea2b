// Relations that hold keyframes to each other while their scans are adjusted together: the path as it was measured, and
// the loops that closed it. Frame: none, relations alone. Thread-safe; linear in the keyframes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/loops/measured_path.hpp"

namespace gdtslam {

/// The place of a keyframe among `kept`, ascending, if it is there.
std::optional<std::size_t> number_in(std::span<const std::size_t> kept, std::size_t keyframe);

/// From one kept keyframe to the next, by wheels and by the front end as far as they are believed, and what the front
/// end says of stretches of its local map in which all keyframes are kept. `kept` are keyframes, ascending; relations
/// have their places in it.
std::vector<PoseRelation> held_path(const MeasuredPath& measured, std::span<const std::size_t> kept);

/// The loops that are on, with their weights, between kept keyframes: two passes may be too far apart for their points
/// to hold them together. `places` are the keyframes of the graph's nodes.
std::vector<PoseRelation> held_loops(const PoseGraph& graph, std::span<const std::size_t> places,
                                     std::span<const std::size_t> kept);

}  // namespace gdtslam
