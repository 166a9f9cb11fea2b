// The nodding mount in motion, in 3D with VTK: the four bars with joints and ground, the curve of a coupler point, the
// laser with its fan of beams. The panel shows crank angle and elevation, the elevation over the crank with a running
// mark, dead points, transmission angle. Frame of the linkage: four_bar.hpp, drawn upright as on the robot (x forward,
// z up), so that elevation 0 is level. One object belongs to one thread.
#pragma once

#include <memory>
#include <string>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/film.hpp"
#include "gdtslam/viewer/graphics.hpp"

namespace gdtslam {

/// Appearance of a linkage.
struct LinkageLook {
  bool is_dark = false;
  bool is_transparent = false;
  bool with_panel = true;     ///< read-outs and plots beside the scene
  std::uint32_t samples = 2;  ///< per pixel side, for smooth edges
};

/// A linkage in motion.
class LinkageScene {
 public:
  /// Throws ConfigError if the loop closes at no crank angle.
  LinkageScene(const GraphicsContext& graphics, const calib::SweepModel& model, const LinkageLook& look);
  ~LinkageScene();
  LinkageScene(const LinkageScene&) = delete;
  LinkageScene& operator=(const LinkageScene&) = delete;

  /// The scene without words, at a crank angle at which the loop closes; else the parts keep their positions.
  RgbaImage render(double crank_rad, const PictureSize& size);
  /// Scene with panel.
  Canvas picture(double crank_rad, const PictureSize& size);
  /// The crank angle for a still: in the lift, with coupler and rocker nearest to a right angle.
  [[nodiscard]] double shown_crank_rad() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One turn of the crank from the start of the lift; there and back if the crank cannot turn fully.
std::unique_ptr<Film> linkage_film(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size,
                                   std::size_t frames);

}  // namespace gdtslam
