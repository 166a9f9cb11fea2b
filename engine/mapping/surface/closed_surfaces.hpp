// A scan's returns with the walls between them. A wall at a grazing angle returns a point every few decimetres; in a
// map of those points alone the next scan fits best where its beams end on the same points again, so that a robot in a
// bare corridor seems to stand still. Frame: the robot when it was scanned. Thread-safe; linear in the points and in
// the length of the walls.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// The returns in beam order, and points at most `spacing_m` apart between the two in the middle of four neighbouring
/// beams that end on one line: nothing can stand open there that is wider than what the beams leave unseen.
std::vector<Point2> with_surfaces_closed(std::span<const Point2> points_base_m, double spacing_m);

/// The direction (robot frame, of length 1) of the wall that the return with this number is on, by its neighbours in
/// beam order, where the nearest of them is farther than half a metre; nothing for any other return.
std::optional<Point2> lone_on_wall(std::span<const Point2> points_base_m, std::size_t at);

}  // namespace gdtslam
