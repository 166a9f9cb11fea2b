// Meshes of the mount's and the robot's parts: extruded outlines with a chamfer, tubes along a path, sectors, each with
// its normals. Metres; outlines lie in the plane of x and z and are extruded along y, where the viewer stands at
// negative y. One object belongs to one thread; O(vertices).
#pragma once

#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <array>
#include <vector>

#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/colour.hpp"

class vtkPolyData;

namespace gdtslam {

/// A closed convex curve, counter-clockwise as seen from negative y, with its outward normals.
struct Outline {
  std::vector<Point2> points;
  std::vector<Point2> normals;
};
Outline circle_outline(const Point2& centre, double radius, int steps = 40);
/// A bar with round ends about both joints.
Outline bar_outline(const Point2& from, const Point2& to, double radius);
Outline rectangle_outline(const Point2& lowest, const Point2& highest, double corner_radius);
/// Corners in order; edges are sharp.
Outline polygon_outline(const std::vector<Point2>& corners);

class Mesh {
 public:
  /// From `front_y` (less) to `back_y`, both ends chamfered.
  void extrude(const Outline& outline, double front_y, double back_y, double chamfer);
  void tube(const std::vector<Point3>& path, double radius, bool is_closed);
  /// A flat band between two curves of equally many points, seen from both sides.
  void band(const std::vector<Point3>& inner, const std::vector<Point3>& outer);
  void ball(const Point3& centre, double radius);
  void move(const Pose3& T_frame_mesh);

  [[nodiscard]] vtkSmartPointer<vtkPolyData> poly_data() const;

 private:
  vtkIdType vertex(const Point3& place, const Point3& normal);
  /// Turned so that its normals point to whom sees it counter-clockwise: VTK turns the normals of all others round.
  void triangle(vtkIdType a, vtkIdType b, vtkIdType c);
  /// Joins two rings of `count` vertices each.
  void join(vtkIdType first, vtkIdType second, std::size_t count, bool is_closed);
  void cap(const std::vector<Point2>& ring, double y, double normal_y);

  std::vector<Point3> places_;
  std::vector<Point3> normals_;
  std::vector<std::array<vtkIdType, 3>> triangles_;
};
Mesh extruded(const Outline& outline, double front_y, double back_y, double chamfer);

}  // namespace gdtslam
