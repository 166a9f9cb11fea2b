// The robot in a cloud: the model with the mount; what is before it hides it. One object belongs to one thread.
#pragma once

#include <memory>
#include <optional>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/pose.hpp"

class vtkRenderer;

namespace gdtslam {

class MountModel;

class CloudRobot {
 public:
  explicit CloudRobot(vtkRenderer& renderer);
  ~CloudRobot();
  CloudRobot(const CloudRobot&) = delete;
  CloudRobot& operator=(const CloudRobot&) = delete;

  /// Hidden without a pose. Builds the model when it is another one than before.
  void set(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model, double elevation_rad);

 private:
  void build(const calib::SweepModel* model);

  vtkRenderer& renderer_;
  const calib::SweepModel* built_of_ = nullptr;
  std::unique_ptr<MountModel> robot_;
};

}  // namespace gdtslam
