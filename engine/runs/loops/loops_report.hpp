// The report of a path with closed loops: each loop, the errors of the wheels, and the stretches that
// are not to be trusted. Thread-safe; linear in scans and loops.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// From this standard deviation on a pose is not to be trusted. On sparse logs 99 % of the poses that are off by 0.3 m
/// are beyond it (docs/loops.md).
inline constexpr double kUncertain_m = 0.2;

/// Scans one after the other whose poses are not to be trusted.
struct UncertainStretch {
  std::size_t from = 0;  ///< indices into the trajectory, the last one included
  std::size_t to = 0;
  double sigma_m = 0.0;  ///< the largest of them
};

/// In the order of the path.
std::vector<UncertainStretch> uncertain_stretches(std::span<const PoseCovariance> covariances);

/// One line that says how much of the path they are, or nothing where there are none.
std::string uncertain_line(std::span<const PoseCovariance> covariances);

nlohmann::ordered_json loops_json(const ClosedPath& closed);
nlohmann::ordered_json wheels_json(const WheelReport& wheels);
/// `trajectory` has the stamps; one pose a covariance.
nlohmann::ordered_json uncertain_json(const ClosedPath& closed, const Trajectory& trajectory);

}  // namespace gdtslam
