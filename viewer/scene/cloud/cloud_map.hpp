// The 2D map lying under a cloud: each stretch of equal cells in a row is one rectangle, so that a map of any size
// stays sharp and what is unknown stays open.
#pragma once

#include <vtkSmartPointer.h>

#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/viewer/camera.hpp"

class vtkActor;

namespace gdtslam {

/// Flat colours without light, at this height. O(cells).
vtkSmartPointer<vtkActor> map_actor(const OccupancyMap& map, double height_m, bool is_dark);
/// The box of the known cells.
Bounds map_bounds(const OccupancyMap& map, double height_m);

}  // namespace gdtslam
