// A comparison as a picture: success against the start's distance from the solution, with its 95 % intervals, and the
// errors of the starts at the odometry's prediction as boxes and as distribution. Pixels. Thread-safe.
#pragma once

#include <string>

#include "figures.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "run.hpp"

namespace gdtslam {

Canvas compare_picture(const CompareJob& job, const CompareOutcome& outcome, const std::string& log);

/// One for each method, the same in all figures.
Colour colour_of_method(MatcherKind method);

}  // namespace gdtslam
