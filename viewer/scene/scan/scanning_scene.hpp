// The robot with its nodding mount among its measurements: points up to a time, the newest ones bright, the beams of
// the last scan, the path, a grid on the floor. Frame map. One object belongs to one thread; a frame costs O(points +
// pixels).
#pragma once

#include <memory>

#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/film.hpp"
#include "scanning_track.hpp"

namespace gdtslam {

class ScanningScene {
 public:
  /// All arguments must outlive the scene. Without a linkage the laser tilts by itself, and only the model's mount is
  /// used.
  ScanningScene(const GraphicsContext& graphics, const ScanningTrack& track, const calib::SweepModel& model,
                bool has_linkage, const Trajectory& trajectory, const CloudLook& look);
  ~ScanningScene();
  ScanningScene(const ScanningScene&) = delete;
  ScanningScene& operator=(const ScanningScene&) = delete;

  /// Moves the scene to that time, and the linkage's crank to this angle.
  void show(double stamp_s, double crank_rad);
  [[nodiscard]] std::uint64_t points_drawn() const;
  [[nodiscard]] const ColourScale& scale() const;
  /// Current pose of the sensor in the robot's model.
  [[nodiscard]] Pose3 T_map_laser() const;
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
