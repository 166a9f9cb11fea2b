// Films: a number of frames, each drawn on request. The caller chooses the file format. One film belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// Frames drawn on request.
class Film {
 public:
  Film() = default;
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  virtual ~Film() = default;
  [[nodiscard]] virtual std::size_t frames() const = 0;
  /// Frame k, counted from 0; all have the same size.
  virtual Canvas frame(std::size_t k) = 0;
};

/// Once around the cloud; the first frame follows the last one without a jump. The scene must outlive the film.
std::unique_ptr<Film> orbit_film(CloudScene& scene, const CloudLook& look, const CloudCaption& caption,
                                 const PictureSize& size, std::size_t frames);
/// Follows the robot from behind along its path, at constant pace; points appear at their time. Afterwards the scene
/// shows all points again, without a robot. Throws InputError for a trajectory without poses.
std::unique_ptr<Film> follow_film(CloudScene& scene, const Trajectory& trajectory, const CloudLook& look,
                                  const CloudCaption& caption, const PictureSize& size, std::size_t frames);

/// Input of the film of a scanning robot.
struct ScanningFilmInput {
  const Cloud* cloud = nullptr;  ///< with times and elevations
  const Trajectory* trajectory = nullptr;
  const calib::SweepModel* model = nullptr;
  bool has_linkage = true;  ///< false: the laser tilts by itself; only the model's mount is valid
  double from_s = 0.0;      ///< time range, in the log's clock
  double to_s = 0.0;
  std::optional<double> zero_s = {};  ///< zero of the displayed times; empty: from_s
};
/// The mount scanning on the robot: robot, linkage and fan of beams in 3D, points that appear at their time, and a
/// running plot of the elevation. Time advances evenly from from_s to to_s.
std::unique_ptr<Film> scanning_film(const GraphicsContext& graphics, const ScanningFilmInput& input,
                                    const CloudLook& look, const CloudCaption& caption, const PictureSize& size,
                                    std::size_t frames);

}  // namespace gdtslam
