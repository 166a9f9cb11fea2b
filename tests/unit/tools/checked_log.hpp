// Records of a log that is made by hand, and its check: what the tests of LogChecker begin with.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "engine/runs/streams/log_check.hpp"

namespace gdtslam {

/// Of a robot without odometry.
inline ScanRecord fixed_scan(double stamp_s, std::vector<float> ranges_m = {1.0F, 2.0F, 3.0F}) {
  return {.scan = {.stamp_s = stamp_s,
                   .first_bearing_rad = -0.5,
                   .bearing_step_rad = 0.5,
                   .max_range_m = 0.0,
                   .ranges_m = std::move(ranges_m),
                   .T_base_laser = {}},
          .T_odom_base = std::nullopt};
}

inline ScanRecord driven_scan(double stamp_s, const Pose2& T_odom_base,
                              std::vector<float> ranges_m = {1.0F, 2.0F, 3.0F}) {
  ScanRecord record = fixed_scan(stamp_s, std::move(ranges_m));
  record.T_odom_base = T_odom_base;
  return record;
}

inline LogCheck checked_log(const std::vector<LogRecord>& records) {
  LogChecker checker{StepBounds{}, ScanConfig{.min_points = 3}};
  for (const LogRecord& record : records) checker.add(record);
  return checker.finish({});
}

}  // namespace gdtslam
