// The top view of measured boxes as SVG: the points around them, their outlines, their dimensions. x points up the
// page, y to the left, as the scanner sees it. Thread-safe; O(points).
#pragma once

#include <span>
#include <string>

#include "gdtslam/core/cloud.hpp"
#include "measure_table.hpp"

namespace gdtslam {

std::string drawing_of(const Measurement& measured, std::span<const CloudPoint> cloud);

}  // namespace gdtslam
