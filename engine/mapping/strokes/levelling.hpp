// Tilt and height of a map in space as a whole, which strokes say nothing about. Frame: map. O(surfels).
#pragma once

#include <array>
#include <span>

#include "surfels.hpp"

namespace gdtslam {

/// The turn about x and y after which walls are upright and floors and ceilings level, by weighted least squares in
/// which steep surfaces do not count. `robot_rad` would level the robot on average, and decides where surfaces say
/// little.
std::array<double, 2> find_levelling_turn(std::span<const Surfel> surfels, const std::array<double, 2>& robot_rad);

/// Height of the floor near `near_m`; `near_m` if there is none.
double find_floor_height(std::span<const Surfel> surfels, double near_m);

}  // namespace gdtslam
