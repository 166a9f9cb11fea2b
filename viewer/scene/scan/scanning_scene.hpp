// The robot with its nodding mount in what it measures: points until a moment, the newest bright, the beams of the last
// scan, the path, a grid on the floor. Frame map. One object belongs to one thread; a frame costs its points and its
// pixels.
#pragma once

#include <memory>

#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/film.hpp"
#include "scanning_track.hpp"

namespace gdtslam {

class ScanningScene {
 public:
  /// All of it must outlive the scene. Without a linkage the laser tilts by itself, and of the model only the mount
  /// counts.
  ScanningScene(const GraphicsContext& graphics, const ScanningTrack& track, const calib::SweepModel& model,
                bool has_linkage, const Trajectory& trajectory, const CloudLook& look);
  ~ScanningScene();
  ScanningScene(const ScanningScene&) = delete;
  ScanningScene& operator=(const ScanningScene&) = delete;

  /// Shows the scene at that moment, with the crank of a linkage at this angle.
  void show(double stamp_s, double crank_rad);
  [[nodiscard]] std::uint64_t points_drawn() const;
  [[nodiscard]] const ColourScale& scale() const;
  /// The sensor, as the model of the robot has it now.
  [[nodiscard]] Pose3 T_map_laser() const;
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
