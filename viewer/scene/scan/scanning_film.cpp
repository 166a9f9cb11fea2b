// The film of the mount on the robot scanning.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "scanning_overlay.hpp"
#include "scanning_scene.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastDistance_m = 1.7;
constexpr double kMostDistance_m = 4.5;
constexpr double kDistanceShare = 0.55;  ///< of the usual range
constexpr double kSway_rad = 0.14;       ///< of the camera to each side: a standing robot's scene gains depth
constexpr double kScanViewAngle_rad = 0.95;

/// Behind the robot on its right side, where the linkage is, from above.
Camera camera_beside(const Pose2& T_map_base, double distance_m, double sway_rad) {
  const Pose2 looking{T_map_base.x_m, T_map_base.y_m, T_map_base.theta_rad + sway_rad};
  const Point2 eye = looking * Point2(-0.80 * distance_m, -0.62 * distance_m);
  const Point2 target = looking * Point2(0.28 * distance_m, 0.06 * distance_m);
  Camera camera;
  camera.eye = {eye.x(), eye.y(), 0.32 + 0.37 * distance_m};
  camera.target = {target.x(), target.y(), 0.42};
  camera.view_angle_rad = kScanViewAngle_rad;
  return camera;
}

const ScanningFilmInput& checked(const ScanningFilmInput& input) {
  if (input.cloud == nullptr || input.trajectory == nullptr || input.model == nullptr) {
    throw UsageError("a film of the scanning needs a cloud with times, the robot's path and the linkage");
  }
  return input;
}

class ScanningFilm : public Film {
 public:
  ScanningFilm(const GraphicsContext& graphics, const ScanningFilmInput& input, const CloudLook& look,
               const CloudCaption& caption, const PictureSize& size, std::size_t frames)
      : model_(*checked(input).model),
        size_(size),
        frames_(frames),
        track_(*input.cloud, *input.trajectory, input.from_s, input.to_s),
        scene_(graphics, track_, model_, input.has_linkage, *input.trajectory, look),
        overlay_(track_, input.zero_s.value_or(input.from_s), look, caption, size),
        distance_m_(std::clamp(kDistanceShare * track_.usual_range_m(), kLeastDistance_m, kMostDistance_m)) {
    if (frames == 0) throw UsageError("a film has at least one frame");
    if (!input.has_linkage) return;
    cycle_.emplace(model_);
    if (overlay_.inset().width <= 0.0) return;
    const LinkageLook close{.is_dark = look.is_dark, .is_transparent = true, .with_panel = false, .samples = 2};
    mount_ = std::make_unique<LinkageScene>(graphics, model_, close);
  }

  [[nodiscard]] std::size_t frames() const override { return frames_; }

  Canvas frame(std::size_t k) override {
    const double share = frames_ > 1 ? static_cast<double>(k) / static_cast<double>(frames_ - 1) : 1.0;
    // The last frame's time is the stretch's end to the bit, so that nothing of it is missing.
    const double stamp_s =
        k + 1 == frames_ ? track_.to_s() : track_.from_s() + share * (track_.to_s() - track_.from_s());
    ScanningMoment moment{.stamp_s = stamp_s, .elevation_rad = track_.elevation_rad(stamp_s)};
    if (cycle_) {
      moment.crank_rad = cycle_->crank_of(moment.elevation_rad, track_.is_rising(stamp_s), model_.encoder.direction);
    }
    scene_.show(stamp_s, moment.crank_rad);
    moment.points = scene_.points_drawn();
    const Camera camera =
        camera_beside(track_.T_map_base_smooth(stamp_s), distance_m_, kSway_rad * sin_cos(kTwoPi * share).sin);
    Canvas canvas(size_.width, size_.height, "A robot with a nodding laser, scanning");
    canvas.picture(Point2::Zero(), size_.width, size_.height,
                   std::make_shared<const RgbaImage>(scene_.render(camera, size_)));
    overlay_.draw(canvas, moment, scene_.scale(), mount_picture(moment.crank_rad));
    return canvas;
  }

 private:
  std::shared_ptr<const RgbaImage> mount_picture(double crank_rad) {
    if (!mount_) return nullptr;
    const PictureSize size{static_cast<std::uint32_t>(overlay_.inset().width) - 2,
                           static_cast<std::uint32_t>(overlay_.inset().height) - 2};
    return std::make_shared<const RgbaImage>(mount_->render(crank_rad, size));
  }

  calib::SweepModel model_;
  PictureSize size_;
  std::size_t frames_;
  ScanningTrack track_;
  std::optional<calib::LinkageCycle> cycle_;
  ScanningScene scene_;
  ScanningOverlay overlay_;
  double distance_m_;
  std::unique_ptr<LinkageScene> mount_;
};

}  // namespace

std::unique_ptr<Film> scanning_film(const GraphicsContext& graphics, const ScanningFilmInput& input,
                                    const CloudLook& look, const CloudCaption& caption, const PictureSize& size,
                                    std::size_t frames) {
  return std::make_unique<ScanningFilm>(graphics, input, look, caption, size, frames);
}

}  // namespace gdtslam
