// A point of a cloud in double precision.
#pragma once

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

inline Point3 position_of(const CloudPoint& point) {
  return {static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)};
}

}  // namespace gdtslam
