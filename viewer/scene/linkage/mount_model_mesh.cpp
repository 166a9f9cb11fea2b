#include "mount_model_mesh.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr int kQuarterSteps = 10;
constexpr int kTubeSides = 8;

void add_arc(Outline& outline, const Point2& centre, double radius, double from_rad, double span_rad, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const Point2 normal = calib::unit_at(from_rad + span_rad * i / steps);
    outline.points.push_back(centre + radius * normal);
    outline.normals.push_back(normal);
  }
}

Point3 lifted(const Point2& place, double y) { return {place.x(), y, place.y()}; }

double length_of(const Point3& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); }

/// Some direction at right angles to `along`, near the last one, so that a tube does not twist.
Point3 sideways(const Point3& along, const Point3& last) {
  Point3 side = last - along.dot(last) * along;
  if (length_of(side) < 1e-6) {
    side = std::fabs(along.z()) < 0.9 ? Point3(0, 0, 1).cross(along) : Point3(0, 1, 0).cross(along);
  }
  return side / length_of(side);
}

}  // namespace

Outline circle_outline(const Point2& centre, double radius, int steps) {
  Outline outline;
  add_arc(outline, centre, radius, 0.0, kTwoPi * (steps - 1) / steps, steps - 1);
  return outline;
}

Outline bar_outline(const Point2& from, const Point2& to, double radius) {
  const Point2 along = to - from;
  const double angle_rad = gdtslam::atan2(along.y(), along.x());
  Outline outline;
  add_arc(outline, from, radius, angle_rad + 0.5 * kPi, kPi, 2 * kQuarterSteps);
  add_arc(outline, to, radius, angle_rad - 0.5 * kPi, kPi, 2 * kQuarterSteps);
  return outline;
}

Outline rectangle_outline(const Point2& lowest, const Point2& highest, double corner_radius) {
  const Point2 low = lowest + Point2(corner_radius, corner_radius);
  const Point2 high = highest - Point2(corner_radius, corner_radius);
  Outline outline;
  add_arc(outline, {high.x(), low.y()}, corner_radius, -0.5 * kPi, 0.5 * kPi, kQuarterSteps);
  add_arc(outline, high, corner_radius, 0.0, 0.5 * kPi, kQuarterSteps);
  add_arc(outline, {low.x(), high.y()}, corner_radius, 0.5 * kPi, 0.5 * kPi, kQuarterSteps);
  add_arc(outline, low, corner_radius, kPi, 0.5 * kPi, kQuarterSteps);
  return outline;
}

Outline polygon_outline(const std::vector<Point2>& corners) {
  Outline outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2& from = corners[i];
    const Point2& to = corners[(i + 1) % corners.size()];
    const Point2 along = to - from;
    const double length = std::sqrt(along.x() * along.x() + along.y() * along.y());
    const Point2 normal(along.y() / length, -along.x() / length);
    outline.points.insert(outline.points.end(), {from, to});
    outline.normals.insert(outline.normals.end(), {normal, normal});
  }
  return outline;
}

void Mesh::extrude(const Outline& outline, double front_y, double back_y, double chamfer) {
  const std::size_t count = outline.points.size();
  std::vector<Point2> inner;
  for (std::size_t i = 0; i < count; ++i) {
    inner.push_back(outline.points[i] - chamfer * outline.normals[i]);
  }
  const auto ring = [&](const std::vector<Point2>& places, double y, double normal_y, double share) {
    const auto first = static_cast<vtkIdType>(places_.size());
    for (std::size_t i = 0; i < count; ++i) {
      vertex(lifted(places[i], y), lifted(share * outline.normals[i], normal_y));
    }
    return first;
  };
  const double half = std::sqrt(0.5);
  cap(inner, front_y, -1.0);
  const vtkIdType front_inner = ring(inner, front_y, -half, half);
  const vtkIdType front_outer = ring(outline.points, front_y + chamfer, -half, half);
  join(front_inner, front_outer, count, true);
  const vtkIdType side_front = ring(outline.points, front_y + chamfer, 0.0, 1.0);
  const vtkIdType side_back = ring(outline.points, back_y - chamfer, 0.0, 1.0);
  join(side_front, side_back, count, true);
  const vtkIdType back_outer = ring(outline.points, back_y - chamfer, half, half);
  const vtkIdType back_inner = ring(inner, back_y, half, half);
  join(back_outer, back_inner, count, true);
  cap(inner, back_y, 1.0);
}

Mesh extruded(const Outline& outline, double front_y, double back_y, double chamfer) {
  Mesh mesh;
  mesh.extrude(outline, front_y, back_y, chamfer);
  return mesh;
}

void Mesh::cap(const std::vector<Point2>& ring, double y, double normal_y) {
  Point2 centre = Point2::Zero();
  for (const Point2& place : ring) centre += place / static_cast<double>(ring.size());
  const vtkIdType hub = vertex(lifted(centre, y), {0.0, normal_y, 0.0});
  for (const Point2& place : ring) vertex(lifted(place, y), {0.0, normal_y, 0.0});
  const auto count = static_cast<vtkIdType>(ring.size());
  for (vtkIdType i = 0; i < count; ++i) triangle(hub, hub + 1 + i, hub + 1 + (i + 1) % count);
}

void Mesh::tube(const std::vector<Point3>& path, double radius, bool is_closed) {
  Point3 side(0.0, 1.0, 0.0);
  const std::size_t count = path.size();
  std::vector<vtkIdType> rings;
  for (std::size_t i = 0; i < count; ++i) {
    const Point3& before = path[i > 0 ? i - 1 : (is_closed ? count - 1 : 0)];
    const Point3& after = path[i + 1 < count ? i + 1 : (is_closed ? 0 : count - 1)];
    const double length = length_of(after - before);
    if (!(length > 0.0)) continue;
    const Point3 along = (after - before) / length;
    side = sideways(along, side);
    const Point3 up = along.cross(side);
    rings.push_back(static_cast<vtkIdType>(places_.size()));
    for (int k = 0; k < kTubeSides; ++k) {
      const Point2 unit = calib::unit_at(kTwoPi * k / kTubeSides);
      const Point3 normal = unit.x() * side + unit.y() * up;
      vertex(path[i] + radius * normal, normal);
    }
  }
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) join(rings[i], rings[i + 1], kTubeSides, true);
  if (is_closed && rings.size() > 2) join(rings.back(), rings.front(), kTubeSides, true);
}

void Mesh::band(const std::vector<Point3>& inner, const std::vector<Point3>& outer) {
  Point3 normal(0.0, -1.0, 0.0);
  if (inner.size() > 1) {
    const Point3 across = (outer.front() - inner.front()).cross(outer.back() - inner.front());
    if (length_of(across) > 0.0) normal = across / length_of(across);
  }
  const auto first = static_cast<vtkIdType>(places_.size());
  for (const Point3& place : inner) vertex(place, normal);
  const auto second = static_cast<vtkIdType>(places_.size());
  for (const Point3& place : outer) vertex(place, normal);
  join(first, second, inner.size(), false);
}

void Mesh::ball(const Point3& centre, double radius) {
  constexpr int kRings = 12;
  constexpr int kSides = 20;
  std::vector<vtkIdType> rings;
  for (int i = 0; i <= kRings; ++i) {
    const Point2 height = calib::unit_at(kPi * i / kRings - 0.5 * kPi);
    rings.push_back(static_cast<vtkIdType>(places_.size()));
    for (int k = 0; k < kSides; ++k) {
      const Point2 round = calib::unit_at(kTwoPi * k / kSides);
      const Point3 normal(height.x() * round.x(), height.x() * round.y(), height.y());
      vertex(centre + radius * normal, normal);
    }
  }
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) join(rings[i], rings[i + 1], kSides, true);
}

void Mesh::move(const Pose3& T_frame_mesh) {
  for (Point3& place : places_) place = T_frame_mesh * place;
  for (Point3& normal : normals_) normal = Pose3{Point3::Zero(), T_frame_mesh.rotation} * normal;
}

vtkSmartPointer<vtkPolyData> Mesh::poly_data() const {
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto normals = vtkSmartPointer<vtkFloatArray>::New();
  normals->SetNumberOfComponents(3);
  normals->SetName("Normals");
  for (std::size_t i = 0; i < places_.size(); ++i) {
    points->InsertNextPoint(places_[i].data());
    normals->InsertNextTuple3(normals_[i].x(), normals_[i].y(), normals_[i].z());
  }
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const auto& corner : triangles_) cells->InsertNextCell(3, corner.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->GetPointData()->SetNormals(normals);
  data->SetPolys(cells);
  return data;
}

vtkIdType Mesh::vertex(const Point3& place, const Point3& normal) {
  places_.push_back(place);
  normals_.push_back(normal);
  return static_cast<vtkIdType>(places_.size()) - 1;
}

void Mesh::triangle(vtkIdType a, vtkIdType b, vtkIdType c) {
  const auto place = [&](vtkIdType i) { return places_[static_cast<std::size_t>(i)]; };
  const auto normal = [&](vtkIdType i) { return normals_[static_cast<std::size_t>(i)]; };
  const Point3 facing = (place(b) - place(a)).cross(place(c) - place(a));
  const bool is_turned = facing.dot(normal(a) + normal(b) + normal(c)) < 0.0;
  triangles_.push_back(is_turned ? std::array<vtkIdType, 3>{a, c, b} : std::array<vtkIdType, 3>{a, b, c});
}

void Mesh::join(vtkIdType first, vtkIdType second, std::size_t count, bool is_closed) {
  const auto size = static_cast<vtkIdType>(count);
  for (vtkIdType i = 0; i + (is_closed ? 0 : 1) < size; ++i) {
    const vtkIdType next = (i + 1) % size;
    triangle(first + i, second + i, second + next);
    triangle(first + i, second + next, first + next);
  }
}

}  // namespace gdtslam
