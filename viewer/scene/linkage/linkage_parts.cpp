#include "linkage_parts.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkLinearExtrusionFilter.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkTriangleFilter.h>
#include <vtkTubeFilter.h>

#include <algorithm>
#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kArcStep_rad = 0.05 * kPi;
constexpr double kEdge_rad = 0.5;  ///< faces that meet at a larger angle have an edge

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

constexpr Colour kSteel = colour_for(0x31363d);
constexpr double kFanHalfWidth_rad = 1.05;
constexpr Colour kHousing = colour_for(0xc3c8cf);
constexpr Colour kCapWhite = colour_for(0xfdfdfb);
constexpr Colour kCradle = colour_for(0x8b929b);

/// Pose at a point in the x-z plane, with the part's x raised by the angle.
Pose3 planar(const Point2& place, double y, double angle_rad) {
  return {{place.x(), y, place.y()}, exp_so3(Point3(0.0, -angle_rad, 0.0))};
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

vtkSmartPointer<vtkActor> make_actor(const Mesh& mesh, Colour colour, Finish finish, double opacity) {
  const auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
  mapper->SetInputData(mesh);
  mapper->ScalarVisibilityOff();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  vtkProperty& property = *actor->GetProperty();
  property.SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
  property.SetOpacity(opacity);
  property.SetInterpolationToPhong();
  const bool is_flat = finish == Finish::kFlat;
  property.SetAmbient(is_flat ? 1.0 : 0.42);
  property.SetDiffuse(is_flat ? 0.0 : 0.82);
  property.SetSpecular(is_flat ? 0.0 : (finish == Finish::kPaint ? 0.12 : 0.45));
  property.SetSpecularPower(finish == Finish::kGlass ? 60.0 : 25.0);
  return actor;
}

void Part::add(const Mesh& mesh, Colour colour, Finish finish, double opacity) {
  actors.push_back(make_actor(mesh, colour, finish, opacity));
}

void Part::move(const Pose3& T_world_part) {
  const Eigen::Matrix3d rotation = rotation_matrix(T_world_part.rotation);
  const auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix->SetElement(row, column, rotation(row, column));
    matrix->SetElement(row, 3, T_world_part.translation_m[row]);
  }
  for (const auto& actor : actors) actor->SetUserMatrix(matrix);
}

void Part::show(bool is_visible) {
  for (const auto& actor : actors) actor->SetVisibility(is_visible ? 1 : 0);
}

void Part::add_to(vtkRenderer& renderer) const {
  for (const auto& actor : actors) renderer.AddActor(actor);
}

PartSizes suitable_sizes(const calib::FourBar& bars) {
  const double longest_m = std::max({bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m});
  const double shortest_m = std::min({bars.crank_m, bars.coupler_m, bars.rocker_m, bars.ground_m});
  // Thin enough that the pins of the shortest bar do not touch.
  const double bar_m = std::min(0.048 * longest_m, 0.28 * shortest_m);
  return {.bar_m = bar_m, .laser_m = 0.42 * longest_m, .fan_m = 1.5 * std::max(bars.rocker_m, 0.6 * longest_m)};
}

LinkageParts::LinkageParts(const calib::SweepModel& model, const PartSizes& sizes) : model_(model), sizes_(sizes) {
  build_ground();
  build_bars();
  build_laser();
  build_fan();
}

double LinkageParts::thickness_m() const { return 1.1 * sizes_.bar_m; }

double LinkageParts::layer_y(int layer) const {
  const double ground_y = -(0.62 * sizes_.laser_m + thickness_m());
  return ground_y - 1.2 * thickness_m() * layer;
}

void LinkageParts::add_pin(Part& part, const Point2& at, double back_y, int front_layer) const {
  const double radius = 0.74 * sizes_.bar_m;
  const double front_y = layer_y(front_layer) - 0.5 * thickness_m() - 0.12 * sizes_.bar_m;
  part.add(extruded({at}, radius, front_y, back_y), kSteel, Finish::kSteel);
  part.add(extruded({at}, 0.68 * radius, front_y - 0.03 * sizes_.bar_m, front_y), kCapWhite, Finish::kFlat);
}

void LinkageParts::build_bars() {
  const calib::FourBar& bars = model_.bars;
  const auto add_bar = [&](Part& part, double length_m, int layer, Colour colour) {
    const double y = layer_y(layer);
    part.add(extruded({{0.0, 0.0}, {length_m, 0.0}}, sizes_.bar_m, y - 0.5 * thickness_m(), y + 0.5 * thickness_m()),
             colour);
  };
  add_bar(rocker_, bars.rocker_m, 1, ink::kRocker);
  add_bar(crank_, bars.crank_m, 2, ink::kCrank);
  add_bar(coupler_, bars.coupler_m, 3, ink::kCoupler);
  add_pin(rocker_, {0.0, 0.0}, -0.5 * sizes_.laser_m, 1);
  add_pin(rocker_, {bars.rocker_m, 0.0}, layer_y(1), 3);
  add_pin(crank_, {0.0, 0.0}, layer_y(0), 2);
  add_pin(crank_, {bars.crank_m, 0.0}, layer_y(2), 3);
}

void LinkageParts::build_ground() {
  const Point2 crank_pivot = calib::place_in_mount(model_, Point2::Zero());
  const double front_y = layer_y(0) - 0.5 * thickness_m();
  const double back_y = layer_y(0) + 0.5 * thickness_m();
  ground_.add(extruded({crank_pivot, Point2::Zero()}, 0.85 * sizes_.bar_m, front_y, back_y), ink::kGround);
  if (!sizes_.with_feet) {
    // A motor behind the crank's pivot, clear of the swinging laser.
    ground_.add(extruded({crank_pivot}, 1.7 * sizes_.bar_m, back_y, back_y + 0.3 * sizes_.laser_m), kSteel,
                Finish::kSteel);
    return;
  }
  const double foot_m = 3.4 * sizes_.bar_m;
  std::vector<std::vector<Point3>> hatch;
  for (const Point2& pivot : {crank_pivot, Point2(Point2::Zero())}) {
    const Point2 left = pivot + Point2(-0.62 * foot_m, -foot_m);
    const Point2 right = pivot + Point2(0.62 * foot_m, -foot_m);
    const Point2 top(0.34 * foot_m, 0.0);
    ground_.add(extruded({left, right, pivot + top, pivot - top}, 0.0, front_y, back_y), ink::kGround);
    for (int i = 0; i < 6; ++i) {
      const Point3 from(left.x() - 0.12 * foot_m + 0.31 * foot_m * i, layer_y(0), left.y());
      hatch.push_back({from, from + Point3(-0.26 * foot_m, 0.0, -0.34 * foot_m)});
    }
  }
  ground_.add(tubes(hatch, 0.09 * sizes_.bar_m), ink::kGround);
}

Pose3 T_axis_laser(const NoddingMount& mount, double elevation_rad) {
  const Pose3 T_axis_level{{mount.lever_forward_m, 0.0, mount.lever_up_m}, Eigen::Quaterniond::Identity()};
  return T_axis_level * T_level_laser(mount, elevation_rad);
}

Part laser_part(double side) {
  Part laser;
  const auto add_disc = [&](double radius, double from_z, double to_z, Colour colour, Finish finish) {
    laser.add(upright({Point2::Zero()}, radius * side, from_z * side, to_z * side), colour, finish);
  };
  const RoundedBox housing{{-0.5 * side, -0.62 * side}, {0.5 * side, -0.14 * side}, 0.07 * side};
  laser.add(extruded(housing.corners(), housing.radius, -0.5 * side, 0.5 * side), kHousing);
  add_disc(0.42, -0.16, -0.10, ink::kLaser, Finish::kPaint);
  add_disc(0.38, -0.12, 0.12, colour_for(0x17191d), Finish::kGlass);
  add_disc(0.42, 0.11, 0.27, kHousing, Finish::kPaint);
  return laser;
}

void LinkageParts::build_laser() {
  const double side = sizes_.laser_m;
  laser_ = laser_part(side);
  const Point2 lever(model_.mount.lever_forward_m, model_.mount.lever_up_m);
  for (const double middle_y : {-0.555 * side, 0.555 * side}) {
    cradle_.add(extruded({Point2::Zero(), lever + Point2(0.0, -0.5 * side)}, 0.1 * side, middle_y - 0.03 * side,
                         middle_y + 0.03 * side),
                kCradle, Finish::kSteel);
  }
  const RoundedBox plate{lever + Point2(-0.42 * side, -0.68 * side), lever + Point2(0.42 * side, -0.62 * side),
                         0.02 * side};
  cradle_.add(extruded(plate.corners(), plate.radius, -0.57 * side, 0.57 * side), kCradle, Finish::kSteel);
}

void LinkageParts::build_fan() {
  if (sizes_.fan_m <= 0.0) return;
  constexpr int kBeams = 17;
  const double inner_m = std::min(0.42 * sizes_.laser_m, 0.5 * sizes_.fan_m);
  fan_.add(band(fan_arc(inner_m), fan_arc(sizes_.fan_m)), ink::kLaser, Finish::kFlat, 0.24);
  std::vector<std::vector<Point3>> beams;
  for (int i = 0; i < kBeams; ++i) {
    const Point2 unit = calib::unit_at(kFanHalfWidth_rad * (2.0 * i / (kBeams - 1) - 1.0));
    const double length_m = beam_length_m(unit, sizes_.fan_m);
    const Point3 along(unit.x(), unit.y(), 0.0);
    if (length_m > inner_m) beams.push_back({inner_m * along, length_m * along});
  }
  // Opaque: VTK blends translucent props without an order, which makes such thin ones nearly white.
  fan_.add(tubes(beams, 0.0024 * sizes_.fan_m), colour_for(0xe8b04a), Finish::kFlat);
}

double LinkageParts::beam_length_m(const Point2& unit, double most_m) const {
  // The linkage blocks the right side; its own shadow is not shown.
  const double wall_y = layer_y(0) + thickness_m();
  return unit.y() < 0.0 ? std::min(most_m, wall_y / unit.y()) : most_m;
}

std::vector<Point3> LinkageParts::fan_arc(double radius_m) const {
  constexpr int kSteps = 96;
  std::vector<Point3> places;
  for (int i = 0; i <= kSteps; ++i) {
    const Point2 unit = calib::unit_at(kFanHalfWidth_rad * (2.0 * i / kSteps - 1.0));
    const double length_m = beam_length_m(unit, radius_m);
    places.emplace_back(length_m * unit.x(), length_m * unit.y(), 0.0);
  }
  return places;
}

void LinkageParts::add_to(vtkRenderer& renderer) const {
  for (const Part& part : parts_) part.add_to(renderer);
}

std::optional<LinkageParts::Poses> LinkageParts::poses_at(const Pose3& T_world_axis, double crank_rad) const {
  const std::optional<calib::LinkagePosition> position = calib::position_at(model_, crank_rad);
  if (!position) return std::nullopt;
  const auto& [crank_pivot, crank_end, coupler_end, axis] = position->joints;
  const auto angle = [this](double rad) { return model_.elevation_sign * rad + model_.elevation_offset_rad; };
  const Pose3 T_world_laser = T_world_axis * T_axis_laser(model_.mount, position->elevation_rad);
  return Poses{T_world_axis,
               T_world_axis * planar(crank_pivot, 0.0, angle(crank_rad)),
               T_world_axis * planar(crank_end, 0.0, angle(position->pose.coupler_rad)),
               T_world_axis * planar(axis, 0.0, angle(position->pose.rocker_rad)),
               T_world_axis * planar(axis, 0.0, position->elevation_rad),
               T_world_laser,
               T_world_laser};
}

bool LinkageParts::pose(const Pose3& T_world_axis, double crank_rad) {
  const std::optional<Poses> poses = poses_at(T_world_axis, crank_rad);
  for (std::size_t k = 0; poses && k < kCount; ++k) parts_.at(k).move(poses->at(k));
  return poses.has_value();
}

void LinkageParts::show(bool is_visible) {
  for (Part& part : parts_) part.show(is_visible);
}

}  // namespace gdtslam
