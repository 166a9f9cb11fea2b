// The position of a point of a cloud, in double precision.
#pragma once

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

inline Point3 to_position(const CloudPoint& point) {
  return {static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)};
}

/// A point without time and scan there.
inline CloudPoint to_cloud_point(const Point3& position) {
  return {.x_m = static_cast<float>(position.x()),
          .y_m = static_cast<float>(position.y()),
          .z_m = static_cast<float>(position.z())};
}

/// True if its position is finite; its other values do not count.
inline bool is_finite(const CloudPoint& point) { return to_position(point).allFinite(); }

}  // namespace gdtslam
