// Cameras of 3D scenes. Frame: map, z up, metres. Thread-safe, constant time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// An axis-parallel box; empty while lowest is beyond highest.
struct Bounds {
  Point3 lowest{1e300, 1e300, 1e300};
  Point3 highest{-1e300, -1e300, -1e300};
  [[nodiscard]] bool is_empty() const { return lowest.x() > highest.x(); }
  [[nodiscard]] Point3 centre() const { return 0.5 * (lowest + highest); }
  void add(const Point3& point);
  [[nodiscard]] bool holds(const Point3& point) const;
};

/// Place and kind of the camera that takes a picture.
struct Camera {
  Point3 eye{0.0, -10.0, 10.0};
  Point3 target = Point3::Zero();
  Point3 up{0.0, 0.0, 1.0};
  double view_angle_rad = 0.6;  ///< vertical; not used by a parallel camera
  bool is_parallel = false;
  double parallel_height_m = 10.0;  ///< height of the scene from the picture's bottom to its top
};

/// Standard positions of a camera.
enum class CameraPreset : std::uint8_t {
  kIso,     ///< from the south-west, the longer side turned to the picture's longer side, 38 degrees down
  kTop,     ///< straight down, parallel; up is the map's y, or x if that fills the picture better
  kFront,   ///< along +y, parallel
  kSide,    ///< along -x, parallel
  kFollow,  ///< behind the robot, along its path
};

/// The nearest camera that shows the whole box with a margin of 6 % of the picture on each side; for every preset but
/// kFollow, which needs a robot. An empty box is treated as a cube of one metre about the origin.
Camera fitting_camera(CameraPreset preset, const Bounds& bounds, const PictureSize& size);
/// The iso camera that keeps the box in the picture while it turns about its target.
Camera orbit_camera(const Bounds& bounds, const PictureSize& size);
/// Camera above a point of the plane, at a height below room ceilings, that looks at the robot and past it.
Camera follow_camera(const Point2& place, const Pose2& T_map_base);
/// The camera rotated about the vertical through its target, counter-clockwise from above.
Camera turned(const Camera& camera, double angle_rad);

/// "EYE_X,EYE_Y,EYE_Z,TARGET_X,TARGET_Y,TARGET_Z[,ANGLE]", metres. ANGLE is the vertical view angle in degrees; with
/// the suffix m it is the visible height in metres of a parallel camera. Up is z, or y if the camera looks straight up
/// or down. Throws UsageError.
Camera parse_camera(const std::string& text);

/// Projects a point to pixels from the upper left corner. Empty behind the camera.
std::optional<Point2> project(const Camera& camera, const PictureSize& size, const Point3& point);

/// Pixels per metre across the line of sight at this point; 0 behind a camera.
double pixels_per_metre(const Camera& camera, const PictureSize& size, const Point3& point);

// Axes of a camera's picture, in the map.

/// Unit vectors: right and up in the picture, forward along the line of sight.
struct CameraBasis {
  Point3 right;
  Point3 up;
  Point3 forward;
};
/// Also valid if the camera's up is along the line of sight: then up is another direction.
CameraBasis camera_basis(const Camera& camera);
/// Half of the vertical view angle as a slope.
double half_height_slope(const Camera& camera);

/// The nearest perspective camera with this line of sight that shows all points within a margin of this share on each
/// side. `centre` is any position among the points.
Camera nearest_camera(const Point3& forward, double view_angle_rad, const Point3& centre,
                      const std::vector<Point3>& points, const PictureSize& size, double margin_share);

}  // namespace gdtslam
