// The distance field of a group of points, for the certified search. Frame: the points'. Cost: some milliseconds for
// each thousand square metres.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// Cells of resolution_m, distances up to what a map counts by default. One at a time is made on a backend, which the
/// mutex sees to. Throws InputError where the points reach over more than 32767 cells, ConfigError where those
/// distances do over less than one or more than 255.
FieldCopy make_distance_field(const std::vector<Point2>& points_m, double resolution_m, Backend& backend,
                              std::mutex& backend_mutex);

/// Every so many-th point, `most` at most.
std::vector<Point2> every_nth(const std::vector<Point2>& points, std::size_t most);

}  // namespace gdtslam
