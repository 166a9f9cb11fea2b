// Localised scans on their map as a picture: the obstacles in grey, each pose found as an arrow, those that are not
// where the reference has them in red with a line to it. Pixels, x of the map right, y up. Thread-safe; O(cells).
#pragma once

#include "gdtslam/drawing/canvas.hpp"
#include "localize_run.hpp"
#include "localize_scans.hpp"

namespace gdtslam {

Canvas localize_picture(const LocalizeJob& job, const Localizer& localizer, const Localized& all);

}  // namespace gdtslam
