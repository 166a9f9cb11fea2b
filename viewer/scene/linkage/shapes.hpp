// Shapes of the mount's and the robot's parts, from VTK's sources: triangles with normals. Metres; outlines lie in the
// plane of x and z and are extruded along y, where the viewer stands at negative y. Thread-safe; O(vertices).
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

using Mesh = vtkSmartPointer<vtkPolyData>;

/// All that lies within `radius` of a convex polygon, its corners counter-clockwise as seen from negative y: of one
/// corner a disc, of two a bar with round ends.
Mesh extruded(std::vector<Point2> corners, double radius, double front_y, double back_y);
/// The same for a polygon of x and y, from one height to another.
Mesh upright(const std::vector<Point2>& corners, double radius, double low_z, double high_z);
/// A rectangle whose corners are rounded, by its lowest and its highest place.
struct RoundedBox {
  Point2 lowest;
  Point2 highest;
  double radius = 0.0;
  [[nodiscard]] std::vector<Point2> corners() const;
};
/// Tubes along paths; consecutive points of a path that coincide are one.
Mesh tubes(const std::vector<std::vector<Point3>>& paths, double radius);
/// A flat band between two curves of equally many points.
Mesh band(const std::vector<Point3>& inner, const std::vector<Point3>& outer);
Mesh ball(const Point3& centre, double radius);

}  // namespace gdtslam
