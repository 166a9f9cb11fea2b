// A linkage as a drawing (1280 by 800): its positions over the lift, the curve of the coupler's middle, the
// rocker's arc, dead points and the laser's plane; beside it elevation and transmission angle over the crank, and the
// figures that matter. The linkage stands as in the mount: the laser's plane is drawn along the rocker, so elevation 0
// is level. The same bytes on every host. Thread-safe.
#pragma once

#include "gdtslam/drawing/canvas.hpp"
#include "linkage_table.hpp"

namespace gdtslam {

Canvas drawing_of(const LinkageSummary& summary);

}  // namespace gdtslam
