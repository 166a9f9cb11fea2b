#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

void Bounds::add(const Point3& point) {
  lowest = lowest.cwiseMin(point);
  highest = highest.cwiseMax(point);
}

const std::vector<CameraPresetName>& camera_presets() {
  static const std::vector<CameraPresetName> presets{
      {CameraPreset::kIso, "iso", "from a corner, 35 degrees down"},
      {CameraPreset::kTop, "top", "straight down, without perspective"},
      {CameraPreset::kFront, "front", "along y, without perspective"},
      {CameraPreset::kSide, "side", "along -x, without perspective"},
      {CameraPreset::kFollow, "follow", "behind and above the robot"},
  };
  return presets;
}

}  // namespace gdtslam
