#include "scene/cloud_robot.hpp"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>

#include <set>

#include "scene/mount_model.hpp"

namespace gdtslam {
namespace {

// Depths go to the nearest fiftieth of their range: before all that is not drawn so, in their order among themselves.
constexpr const char* kInFront =
    "//VTK::PositionVC::Impl\n"
    "  gl_Position.z = 0.02 * gl_Position.z - 0.98 * gl_Position.w;\n";

std::set<vtkActor*> actors_of(vtkRenderer& renderer) {
  std::set<vtkActor*> actors;
  vtkActorCollection* all = renderer.GetActors();
  vtkCollectionSimpleIterator at = nullptr;
  all->InitTraversal(at);
  while (vtkActor* actor = all->GetNextActor(at)) actors.insert(actor);
  return actors;
}

}  // namespace

CloudRobot::CloudRobot(vtkRenderer& renderer) : renderer_(renderer) {}
CloudRobot::~CloudRobot() = default;

void CloudRobot::build(const calib::SweepModel* model) {
  if (robot_) robot_->set_visible(false);
  const std::set<vtkActor*> before = actors_of(renderer_);
  robot_ = std::make_unique<MountModel>(model, MountLook{.with_fan = false, .T_base_level = {}});
  built_of_ = model;
  robot_->add_to(renderer_);
  for (vtkActor* actor : actors_of(renderer_)) {
    if (before.contains(actor)) continue;
    actor->GetShaderProperty()->AddVertexShaderReplacement("//VTK::PositionVC::Impl", true, kInFront, false);
  }
}

void CloudRobot::set(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model, double elevation_rad) {
  if (T_map_base && (!robot_ || built_of_ != model)) build(model);
  if (!robot_) return;
  robot_->set_visible(T_map_base.has_value());
  if (!T_map_base) return;
  robot_->place(*T_map_base);
  robot_->set_elevation(elevation_rad);
}

}  // namespace gdtslam
