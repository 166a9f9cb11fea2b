#include "cloud_robot.hpp"

#include <vtkRenderer.h>

#include "viewer/scene/linkage/mount_model.hpp"

namespace gdtslam {
CloudRobot::CloudRobot(vtkRenderer& renderer) : renderer_(renderer) {}
CloudRobot::~CloudRobot() = default;

void CloudRobot::build(const calib::SweepModel* model) {
  if (robot_) robot_->set_visible(false);
  robot_ = std::make_unique<MountModel>(model, MountLook{});
  built_of_ = model;
  robot_->add_to(renderer_);
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
