// Moving pictures: a number of frames, each drawn when it is asked for. The caller chooses how to write it. One film
// belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// Frames that are drawn when they are asked for.
class Film {
 public:
  Film() = default;
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  virtual ~Film() = default;
  [[nodiscard]] virtual std::size_t frames() const = 0;
  /// Frame k from 0; all have one size.
  virtual Canvas frame(std::size_t k) = 0;
};

/// Once around the cloud; the last frame is followed by the first without a jump. The scene must outlive the film.
std::unique_ptr<Film> orbit_film(CloudScene& scene, const CloudLook& look, const CloudCaption& caption,
                                 const PictureSize& size, std::size_t frames);
/// Follows the robot from behind along its path, at constant speed of time; points appear when they are measured.
/// Afterwards the scene shows all again, without a robot. Throws InputError for a trajectory without poses.
std::unique_ptr<Film> follow_film(CloudScene& scene, const Trajectory& trajectory, const CloudLook& look,
                                  const CloudCaption& caption, const PictureSize& size, std::size_t frames);

/// Input of the film of a scanning robot.
struct ScanningFilmInput {
  const Cloud* cloud = nullptr;  ///< with times and elevations
  const Trajectory* trajectory = nullptr;
  const calib::SweepModel* model = nullptr;
  bool has_linkage = true;  ///< false: the laser tilts by itself, and of the model only the mount counts
  double from_s = 0.0;      ///< stretch of the log, in its clock
  double to_s = 0.0;
  std::optional<double> zero_s = {};  ///< zero of the times in its words; empty: from_s
};
/// The mount on the robot scanning: robot, linkage and fan of beams in 3D, points appearing as they are measured, the
/// elevation over time running along. Time runs evenly from from_s to to_s.
std::unique_ptr<Film> scanning_film(const GraphicsContext& graphics, const ScanningFilmInput& input,
                                    const CloudLook& look, const CloudCaption& caption, const PictureSize& size,
                                    std::size_t frames);

}  // namespace gdtslam
