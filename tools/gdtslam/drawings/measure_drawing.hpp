// Top view of measured boxes: the points around them, their outlines, their dimensions. x points up the page, y to the
// left, as seen by the scanner. Thread-safe; O(points).
#pragma once

#include <span>
#include "engine/runs/evaluation/measure_table.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

Canvas draw_measurement(const Measurement& measured, std::span<const CloudPoint> cloud);

}  // namespace gdtslam
