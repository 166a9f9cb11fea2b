// covariance.csv of a run: how sure each pose of trajectory.tum is within the map, one row a pose in the same order
// (docs/formats.md). Frame: along the map's axes. Thread-safe; O(rows).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// A row of the file.
struct StampedCovariance {
  double stamp_s = 0.0;
  PoseCovariance covariance;
};

/// The header and the rows: stamps as in trajectory.tum, all other numbers in the shortest form that reads back as the
/// same bits. One covariance a pose.
std::string covariance_text(const Trajectory& trajectory, std::span<const PoseCovariance> covariances);

/// Throws InputError with file and line where a row has not seven numbers, or ones that are no covariance: not finite,
/// a variance below zero, or two values that vary together by more than each of them varies; FileError.
std::vector<StampedCovariance> read_covariances(const std::string& path);

}  // namespace gdtslam
