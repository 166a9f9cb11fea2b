#include "shapes.hpp"

#include <vtkCellArray.h>
#include <vtkLinearExtrusionFilter.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataNormals.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkTriangleFilter.h>
#include <vtkTubeFilter.h>

#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kArcStep_rad = 0.05 * kPi;
constexpr double kEdge_rad = 0.5;  ///< faces that meet at more have an edge

Mesh to_triangles(vtkAlgorithm& last) {
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(last.GetOutputPort());
  triangles->PassLinesOff();
  triangles->Update();
  return triangles->GetOutput();
}

Mesh with_normals(vtkAlgorithm& last, bool is_closed) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputConnection(last.GetOutputPort());
  normals->SetFeatureAngle(deg_from_rad(kEdge_rad));
  normals->SetAutoOrientNormals(is_closed ? 1 : 0);
  return to_triangles(*normals);
}

double positive_turn(double angle_rad) { return angle_rad - kTwoPi * std::floor(angle_rad / kTwoPi); }

std::vector<Point2> outline_around(const std::vector<Point2>& corners, double radius) {
  if (!(radius > 0.0)) return corners;
  const std::size_t count = corners.size();
  std::vector<Point2> outline;
  for (std::size_t i = 0; i < count; ++i) {
    const Point2 before = corners[i] - corners[(i + count - 1) % count];
    const Point2 after = corners[(i + 1) % count] - corners[i];
    const double heading_rad = gdtslam::atan2(before.y(), before.x());
    const double turn_rad =
        count == 1 ? kTwoPi - kArcStep_rad : positive_turn(gdtslam::atan2(after.y(), after.x()) - heading_rad);
    const int steps = std::max(1, static_cast<int>(std::lround(turn_rad / kArcStep_rad)));
    for (int k = 0; k <= steps; ++k) {
      outline.push_back(corners[i] + radius * calib::unit_at(heading_rad - 0.5 * kPi + turn_rad * k / steps));
    }
  }
  return outline;
}

vtkSmartPointer<vtkPoints> make_points(const std::vector<Point3>& places) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const Point3& place : places) points->InsertNextPoint(place.data());
  return points;
}

}  // namespace

std::vector<Point2> RoundedBox::corners() const {
  const Point2 low = lowest + Point2(radius, radius);
  const Point2 high = highest - Point2(radius, radius);
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

Mesh extruded(std::vector<Point2> corners, double radius, double front_y, double back_y) {
  if (corners.size() == 2 && (corners[1] - corners[0]).norm() < 1e-9 * radius) corners.pop_back();
  std::vector<Point3> places;
  for (const Point2& place : outline_around(corners, radius)) places.emplace_back(place.x(), front_y, place.y());
  vtkNew<vtkPolyData> outline;
  vtkNew<vtkCellArray> polygon;
  polygon->InsertNextCell(static_cast<int>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) polygon->InsertCellPoint(static_cast<vtkIdType>(i));
  outline->SetPoints(make_points(places));
  outline->SetPolys(polygon);
  vtkNew<vtkLinearExtrusionFilter> extrusion;
  extrusion->SetInputData(outline);
  extrusion->SetExtrusionTypeToVectorExtrusion();
  extrusion->SetVector(0.0, back_y - front_y, 0.0);
  return with_normals(*extrusion, true);
}

Mesh upright(const std::vector<Point2>& corners, double radius, double low_z, double high_z) {
  vtkNew<vtkTransform> turn;  // the outline's z becomes y, its -y becomes up
  turn->RotateX(-90.0);
  vtkNew<vtkTransformPolyDataFilter> turned;
  turned->SetTransform(turn);
  turned->SetInputData(extruded(corners, radius, -high_z, -low_z));
  return to_triangles(*turned);
}

Mesh tubes(const std::vector<std::vector<Point3>>& paths, double radius) {
  std::vector<Point3> places;
  vtkNew<vtkCellArray> lines;
  for (const std::vector<Point3>& path : paths) {
    const std::size_t first = places.size();
    for (const Point3& place : path) {
      if (places.size() == first || (place - places.back()).norm() > 1e-3 * radius) places.push_back(place);
    }
    if (places.size() < first + 2) continue;
    lines->InsertNextCell(static_cast<int>(places.size() - first));
    for (std::size_t i = first; i < places.size(); ++i) lines->InsertCellPoint(static_cast<vtkIdType>(i));
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(make_points(places));
  data->SetLines(lines);
  vtkNew<vtkTubeFilter> tube;
  tube->SetInputData(data);
  tube->SetRadius(radius);
  tube->SetNumberOfSides(8);
  return to_triangles(*tube);
}

Mesh band(const std::vector<Point3>& inner, const std::vector<Point3>& outer) {
  std::vector<Point3> places = inner;
  places.insert(places.end(), outer.begin(), outer.end());
  const auto count = static_cast<vtkIdType>(inner.size());
  vtkNew<vtkCellArray> polygons;
  for (vtkIdType i = 0; i + 1 < count; ++i) polygons->InsertNextCell({i, i + 1, count + i + 1, count + i});
  vtkNew<vtkPolyData> data;
  data->SetPoints(make_points(places));
  data->SetPolys(polygons);
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(data);
  return with_normals(*triangles, false);
}

Mesh ball(const Point3& centre, double radius) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(centre.x(), centre.y(), centre.z());
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(20);
  sphere->SetPhiResolution(12);
  return to_triangles(*sphere);
}

}  // namespace gdtslam
