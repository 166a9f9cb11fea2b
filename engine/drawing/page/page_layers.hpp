// Layers of a page beside its cloud: path, map and linkage, each a description in JSON and an element with bytes.
// Thread-safe.
#pragma once

#include <cstddef>
#include <span>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "page_writer.hpp"

namespace gdtslam::page {

/// Poses as four float32: x, y relative to `origin`, heading, time since the first pose. At most kMostPoses, spread
/// evenly, both ends among them. `drives`: as in PageInput; the description names the first pose of each that has one
/// here. Times never step back: where a clock did by more than a second, or leapt ahead by more than a day, they go
/// on as from drive to drive. `log_times` of the description is 0 where they are not those of the log, which a cloud
/// has.
inline constexpr std::size_t kMostPoses = 50'000;
void write_path(const Trajectory& trajectory, std::span<const std::size_t> drives, const Point2& origin,
                PageData& page);

/// Cells as CellState in two bits, four to a byte, the first in the lowest bits; several cells become one where a side
/// has more than kMostMapSide, the first of occupied, free, unknown that is among them.
inline constexpr std::int32_t kMostMapSide = 4096;
void write_map(const OccupancyMap& map, PageData& page);

/// The linkage at kCrankSteps crank angles of calib/four_bar.hpp from 0 on (theta_input), eight float32 each: joints A
/// and B, the middle of the coupler (x forward, z up, metres, from the crank's pivot; turned so that elevation 0 is
/// level), elevation, transmission angle. Not a number where the loop does not close. The description has how long the
/// laser's line is drawn, what all positions together cover, both pivots included, and the step at which motion starts:
/// the begin of the lift.
inline constexpr int kCrankSteps = 720;
void write_linkage(const calib::SweepModel& model, PageData& page);

}  // namespace gdtslam::page
