// The axes of a camera's picture, in the map. Constant time.
#pragma once

#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

/// Unit vectors: right and up in the picture, forward along the line of sight.
struct CameraBasis {
  Point3 right;
  Point3 up;
  Point3 forward;
};
/// Also where the camera's up is along the line of sight: then another direction is up.
CameraBasis basis_of(const Camera& camera);
/// Half of the vertical view angle as a slope.
double half_height_slope(const Camera& camera);

/// The nearest perspective camera with this line of sight that has all points in its picture, but for a margin of this
/// share on each side. `centre` is any place among the points.
Camera nearest_camera(const Point3& forward, double view_angle_rad, const Point3& centre,
                      const std::vector<Point3>& points, const PictureSize& size, double margin_share);

}  // namespace gdtslam
