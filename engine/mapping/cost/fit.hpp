// How well a scan fits a map at some poses, wherever the map lives. Frame: map. Not thread-safe. Cost: one evaluation a
// pose.
#pragma once

#include <array>
#include <span>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "objective.hpp"

namespace gdtslam {

/// The mean distance of the points from the map at two poses, metres; none counts for more than `farthest_m`. Throws
/// DeviceError where the map's device fails.
std::array<double, 2> mean_distances_m(const GlobalField& map, std::span<const PointCells> points,
                                       const std::array<Pose2, 2>& poses, double farthest_m);

/// Whether the points fit about as well at `pose` as where they were matched, as where little holds a scan: in a bare
/// corridor a match can slide along it for next to nothing. Throws as the above.
bool fits_about_as_well(const GlobalField& map, std::span<const PointCells> points, const Pose2& pose,
                        const Pose2& matched);

}  // namespace gdtslam
