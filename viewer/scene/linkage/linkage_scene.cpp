#include "gdtslam/viewer/linkage_scene.hpp"

#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "engine/drawing/linkage/linkage_drawing.hpp"
#include "gdtslam/core/error.hpp"
#include "linkage_parts.hpp"
#include "viewer/graphics/offscreen_view.hpp"

namespace gdtslam {
namespace {

/// From behind and above the right side: there the fan of beams is never seen from its edge while it swings from level
/// to upright.
constexpr double kAzimuth_rad = -0.30;
constexpr double kHeight_rad = 0.21;
constexpr double kViewAngle_rad = 0.34;
constexpr double kMargin = 0.05;  ///< of the picture's smaller side

Point3 towards_eye() {
  const SinCos<double> azimuth = sin_cos(kAzimuth_rad);
  const SinCos<double> height = sin_cos(kHeight_rad);
  return {azimuth.sin * height.cos, -azimuth.cos * height.cos, height.sin};
}

Eigen::AlignedBox2d seen_extent(const Camera& camera, const PictureSize& size, const std::vector<Point3>& places) {
  Eigen::AlignedBox2d extent;
  for (const Point3& place : places) {
    if (const std::optional<Seen> seen = pixel_of(camera, size, place)) extent.extend(Point2(seen->x_px, seen->y_px));
  }
  return extent;
}

/// Moved and drawn back until all places just fit.
Camera camera_on(const std::vector<Point3>& places, double reach_m, const PictureSize& size) {
  constexpr int kRounds = 8;
  const Point3 back = towards_eye();
  const Point3 right = (-back).cross(Point3(0.0, 0.0, 1.0)).normalized();
  const Point3 up = right.cross(-back);
  double distance_m = 8.0 * reach_m;
  Camera camera;
  camera.view_angle_rad = kViewAngle_rad;
  for (int round = 0; round < kRounds; ++round) {
    camera.eye = camera.target + distance_m * back;
    const Eigen::AlignedBox2d extent = seen_extent(camera, size, places);
    const double px_per_m = pixels_per_metre(camera, size, camera.target);
    const double margin_px = kMargin * std::min(size.width, size.height);
    const Point2 middle = 0.5 * (extent.min() + extent.max());
    camera.target +=
        (middle.x() - 0.5 * size.width) / px_per_m * right - (middle.y() - 0.5 * size.height) / px_per_m * up;
    const Point2 room(size.width - 2.0 * margin_px, size.height - 2.0 * margin_px);
    const Point2 need = extent.max() - extent.min();
    distance_m *= std::max(need.x() / room.x(), need.y() / room.y());
  }
  camera.eye = camera.target + distance_m * back;
  return camera;
}

class LinkageFilm : public Film {
 public:
  LinkageFilm(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size, std::size_t frames)
      : scene_(scene), cycle_(model), size_(size), frames_(frames) {
    if (frames == 0) throw UsageError("a film has at least one frame");
  }
  [[nodiscard]] std::size_t frames() const override { return frames_; }
  Canvas frame(std::size_t k) override {
    return scene_.picture(cycle_.crank_at(static_cast<double>(k) / static_cast<double>(frames_)), size_);
  }

 private:
  LinkageScene& scene_;
  calib::LinkageCycle cycle_;
  PictureSize size_;
  std::size_t frames_;
};

}  // namespace

struct LinkageScene::State {
  State(const GraphicsContext& graphics, const calib::SweepModel& model, const LinkageLook& scene_look)
      : look(scene_look),
        cycle(model),
        parts(model, suitable_sizes(model.bars)),
        panel(cycle, {.is_dark = scene_look.is_dark, .is_transparent = scene_look.is_transparent}),
        surroundings(cycle, parts, panel.theme().text),
        view(graphics) {
    vtkRenderer& renderer = view.renderer();
    parts.add_to(renderer);
    surroundings.add_to(renderer);
    add_lights(renderer);
    view.set_samples(look.samples);
    crank_rad = cycle.shown_crank_rad();
    parts.pose(Pose3{}, crank_rad);
  }

  Camera camera(const PictureSize& size) const { return camera_on(surroundings.reach(), surroundings.reach_m(), size); }

  void draw_sweep_labels(Canvas& canvas, const LinkageSheet& sheet, const PictureSize& size) const {
    const Camera seen_from = camera(size);
    if (cycle.sweeps_all_around()) return;
    for (const double elevation_rad : {cycle.lowest_rad(), cycle.highest_rad()}) {
      const std::optional<Seen> rim = pixel_of(seen_from, size, surroundings.sweep_rim(elevation_rad, 1.0));
      const std::optional<Seen> inner = pixel_of(seen_from, size, surroundings.sweep_rim(elevation_rad, 0.9));
      if (!rim || !inner) continue;
      const Point2& corner = sheet.scene.corner;
      panel.draw_sweep_label(canvas, sheet, corner + Point2(rim->x_px, rim->y_px),
                             corner + Point2(inner->x_px, inner->y_px), elevation_rad);
    }
  }

  LinkageLook look;
  calib::LinkageCycle cycle;
  LinkageParts parts;
  LinkagePanel panel;
  LinkageSurroundings surroundings;
  OffscreenView view;
  double crank_rad = 0.0;
};

LinkageScene::LinkageScene(const GraphicsContext& graphics, const calib::SweepModel& model, const LinkageLook& look)
    : state_(std::make_unique<State>(graphics, model, look)) {}

LinkageScene::~LinkageScene() = default;

RgbaImage LinkageScene::render(double crank_rad, const PictureSize& size) {
  if (state_->parts.pose(Pose3{}, crank_rad)) state_->crank_rad = crank_rad;
  state_->view.set_background(state_->panel.theme().card, state_->look.is_transparent);
  return state_->view.render(state_->camera(size), size);
}

Canvas LinkageScene::picture(double crank_rad, const PictureSize& size) {
  const LinkageSheet sheet = linkage_sheet(size.width, size.height, state_->look.with_panel);
  const PictureSize scene_size{static_cast<std::uint32_t>(std::max(1.0, sheet.scene.width)),
                               static_cast<std::uint32_t>(std::max(1.0, sheet.scene.height))};
  const auto image = std::make_shared<const RgbaImage>(render(crank_rad, scene_size));
  const std::string& name = state_->cycle.model().name;
  Canvas canvas(size.width, size.height, "Linkage " + (name.empty() ? "in motion" : name));
  const bool has_panel = sheet.figures.width > 0.0;
  if (has_panel) state_->panel.draw_ground(canvas, sheet);
  canvas.picture(sheet.scene.corner, scene_size.width, scene_size.height, image);
  if (!has_panel) return canvas;
  state_->draw_sweep_labels(canvas, sheet, scene_size);
  const calib::LinkagePosition position = state_->cycle.at(state_->crank_rad).value_or(state_->cycle.begin());
  state_->panel.draw_figures(canvas, sheet, position);
  state_->panel.draw_plots(canvas, sheet, position);
  return canvas;
}

double LinkageScene::shown_crank_rad() const { return state_->cycle.shown_crank_rad(); }

std::unique_ptr<Film> linkage_film(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size,
                                   std::size_t frames) {
  return std::make_unique<LinkageFilm>(scene, model, size, frames);
}

}  // namespace gdtslam
