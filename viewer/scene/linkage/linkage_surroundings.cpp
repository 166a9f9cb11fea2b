// What stands still around a moving linkage.
#include <vtkActor.h>
#include <vtkLight.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "linkage_parts.hpp"

namespace gdtslam {
namespace {

Point3 at_layer(const Point2& place, double y) { return {place.x(), y, place.y()}; }

/// A path as dashes of about `dash_m` with gaps of the same length.
Mesh dashed(const std::vector<Point3>& path, double radius, double dash_m) {
  std::vector<std::vector<Point3>> dashes(1);
  double length_m = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) length_m += (path[i] - path[i - 1]).norm();
    if (std::fmod(length_m, 2.0 * dash_m) < dash_m) {
      dashes.back().push_back(path[i]);
    } else if (!dashes.back().empty()) {
      dashes.emplace_back();
    }
  }
  return tubes(dashes, radius);
}

}  // namespace

void add_lights(vtkRenderer& renderer) {
  renderer.AutomaticLightCreationOff();
  const auto add = [&](double x, double y, double z, double intensity) {
    const auto light = vtkSmartPointer<vtkLight>::New();
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0.0, 0.0, 0.0);
    light->SetIntensity(intensity);
    renderer.AddLight(light);
  };
  add(-0.7, 1.0, 0.9, 0.75);
  add(0.9, 0.1, 0.8, 0.25);
  add(0.0, 0.0, 1.0, 0.25);
}

LinkageSurroundings::LinkageSurroundings(const calib::LinkageCycle& cycle, const LinkageParts& parts, Colour marks)
    : thin_m_(0.085 * parts.sizes().bar_m),
      sweep_m_(parts.sizes().fan_m),
      sweep_y_(parts.layer_y(0) + parts.sizes().bar_m) {
  add_sweep(cycle);
  add_paths(cycle, parts);
  for (const calib::LinkagePosition* dead_point : {&cycle.begin(), &cycle.end()}) {
    still_.add(ball(at_layer(dead_point->joints[2], parts.layer_y(1)), 0.55 * parts.sizes().bar_m), marks);
  }
}

Point3 LinkageSurroundings::sweep_rim(double elevation_rad, double share) const {
  return at_layer(share * sweep_m_ * calib::unit_at(elevation_rad), sweep_y_);
}

void LinkageSurroundings::add_paths(const calib::LinkageCycle& cycle, const LinkageParts& parts) {
  std::vector<Point3> curve;
  std::vector<Point3> arc;
  std::vector<Point3> circle;
  for (const calib::LinkagePosition& position : cycle.positions()) {
    curve.push_back(at_layer(position.middle, parts.layer_y(3)));
    arc.push_back(at_layer(position.joints[2], parts.layer_y(1)));
    circle.push_back(at_layer(position.joints[1], parts.layer_y(2)));
  }
  still_.add(tubes({curve}, 1.5 * thin_m_), ink::kCurve);
  const double dash_m = 0.5 * parts.sizes().bar_m;
  // The lift's part alone: the return runs over it again.
  const auto lift = static_cast<std::size_t>(static_cast<double>(arc.size() - 1) *
                                             std::fabs(cycle.lift_span_rad() / cycle.span_rad()));
  arc.resize(std::min(arc.size(), lift + 1));
  still_.add(dashed(arc, thin_m_, dash_m), ink::kRocker);
  still_.add(dashed(circle, thin_m_, dash_m), ink::kCrank);
}

void LinkageSurroundings::add_sweep(const calib::LinkageCycle& cycle) {
  constexpr int kSteps = 96;
  constexpr double kClearOfLaser = 0.24;
  const double from_rad = cycle.lowest_rad();
  const double to_rad = std::min(cycle.highest_rad(), from_rad + kTwoPi);
  std::vector<Point3> hub;
  std::vector<Point3> rim;
  for (int i = 0; i <= kSteps; ++i) {
    const double elevation_rad = from_rad + (to_rad - from_rad) * i / kSteps;
    hub.push_back(sweep_rim(elevation_rad, kClearOfLaser));
    rim.push_back(sweep_rim(elevation_rad, 1.0));
  }
  still_.add(band(hub, rim), ink::kLaser, Finish::kFlat, 0.10);
  if (cycle.sweeps_all_around()) return;
  for (const double elevation_rad : {from_rad, to_rad}) {
    std::vector<Point3> edge;
    for (int i = 0; i <= kSteps; ++i) {
      edge.push_back(sweep_rim(elevation_rad, kClearOfLaser + (1.0 - kClearOfLaser) * i / kSteps));
    }
    still_.add(dashed(edge, 0.8 * thin_m_, 0.035 * sweep_m_), ink::kLaser, Finish::kFlat);
  }
}

}  // namespace gdtslam
