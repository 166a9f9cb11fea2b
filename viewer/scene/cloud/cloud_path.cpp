#include "cloud_path.hpp"

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "viewer/scene/linkage/linkage_parts.hpp"

namespace gdtslam {
namespace {

constexpr double kClearance_m = 0.04;      // gap between floor and tube, because the floor's points are noisy
constexpr double kStepWidths = 0.7;        // distance between rings of the tube, in its widths
constexpr double kMarkWidths = 1.6;        // radius of a mark, in widths of the tube
constexpr double kLargestMark_m = 0.12;    // largest radius: no mark hides a robot
constexpr double kLeastMarkWidths = 0.75;  // least radius: a mark stands out from the widest tube
constexpr double kLeastPath_m = 0.2;       // a path that stays nearer to its start has no marks: they would overlap
constexpr double kWidthTolerance = 0.08;   // relative change of the width below which the tube is not rebuilt

void paint(vtkActor& actor, Colour colour, double own_light) {
  vtkProperty& look = *actor.GetProperty();
  look.SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
  look.SetAmbient(own_light);
  look.SetDiffuse(1.0 - own_light);
}

void give(vtkActor& actor, const Mesh& mesh) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(mesh);
  actor.SetMapper(mapper);
}

}  // namespace

CloudPath::CloudPath(vtkRenderer& renderer, bool is_dark) {
  paint(*tube_, is_dark ? colour_for(0xf2efe6) : colour_for(0x2b3036), 0.6);
  paint(*start_, is_dark ? colour_for(0x3fc49a) : ink::kRocker, 0.45);
  paint(*end_, is_dark ? colour_for(0xff8a4c) : ink::kCrank, 0.45);
  for (vtkActor* actor : {tube_.Get(), start_.Get(), end_.Get()}) {
    actor->VisibilityOff();
    renderer.AddActor(actor);
  }
}

CloudPath::~CloudPath() = default;

void CloudPath::set(const Trajectory& trajectory, const FloorHeight& floor_m) {
  places_.clear();
  bounds_ = Bounds{};
  for (const StampedPose& pose : trajectory) {
    if (!pose.T_map_base.is_finite()) continue;
    const Point2 at = pose.T_map_base.translation();
    places_.push_back({.stamp_s = pose.stamp_s, .at = {at.x(), at.y(), floor_m(at) + kClearance_m}});
    bounds_.add(places_.back().at);
  }
  built_count_ = 0;
  built_width_m_ = 0.0;
}

void CloudPath::prepare(double width_m) {
  const auto is_shown = [this](const Place& place) { return !(place.stamp_s > until_s_); };
  const auto count = static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), is_shown));
  const bool is_same_width = std::fabs(width_m - built_width_m_) <= kWidthTolerance * built_width_m_;
  if (count == built_count_ && is_same_width) return;
  built_count_ = count;
  built_width_m_ = width_m;
  for (vtkActor* actor : {tube_.Get(), start_.Get(), end_.Get()}) actor->SetVisibility(count > 0);
  if (count > 0) build(width_m, count);
}

void CloudPath::build(double width_m, std::size_t count) {
  std::vector<Point3> path;
  const Point3 upon(0.0, 0.0, 0.5 * width_m);
  Point3 last = Point3::Zero();
  std::size_t taken = 0;
  for (const Place& place : places_) {
    if (place.stamp_s > until_s_) continue;
    const bool is_end = ++taken == count;
    const Point3 at = place.at + upon;
    if (!path.empty() && (at - path.back()).norm() < kStepWidths * width_m && !is_end) continue;
    path.push_back(at);
    last = at;
  }
  give(*tube_, tubes({path}, 0.5 * width_m));
  double reach_m = 0.0;
  for (const Point3& at : path) reach_m = std::max(reach_m, (at - path.front()).norm());
  for (vtkActor* mark : {start_.Get(), end_.Get()}) mark->SetVisibility(reach_m >= kLeastPath_m);
  const double radius_m = std::max(std::min(kMarkWidths * width_m, kLargestMark_m), kLeastMarkWidths * width_m);
  give(*start_, ball(path.front(), radius_m));
  give(*end_, ball(last, radius_m));
}

}  // namespace gdtslam
