#include "gdtslam/viewer/linkage_scene.hpp"

#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "engine/drawing/linkage/linkage_drawing.hpp"
#include "gdtslam/core/error.hpp"
#include "linkage_parts.hpp"
#include "viewer/graphics/offscreen_view.hpp"
#include "viewer/scene/camera_basis.hpp"

namespace gdtslam {
namespace {

/// From behind and above the right side: there the fan of beams is never seen from its edge while it swings from level
/// to upright.
constexpr double kAzimuth_rad = -0.30;
constexpr double kHeight_rad = 0.21;
constexpr double kViewAngle_rad = 0.34;
constexpr double kMargin = 0.05;  ///< share of the picture's sides

Point3 line_of_sight() {
  const SinCos<double> azimuth = sin_cos(kAzimuth_rad);
  const SinCos<double> height = sin_cos(kHeight_rad);
  return {-azimuth.sin * height.cos, azimuth.cos * height.cos, -height.sin};
}

/// Corners of the boxes around all that is seen, at many positions of the cycle.
std::vector<Point3> places_reached(const calib::LinkageCycle& cycle, LinkageParts& parts, vtkRenderer& renderer) {
  std::vector<Point3> places;
  for (std::size_t i = 0; i < cycle.positions().size(); i += 8) {
    parts.pose(Pose3{}, cycle.positions()[i].crank_rad);
    double box[6];  // least and most x, then y, then z
    renderer.ComputeVisiblePropBounds(box);
    for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7}) {
      places.emplace_back(box[corner & 1], box[2 + (corner >> 1 & 1)], box[4 + (corner >> 2 & 1)]);
    }
  }
  return places;
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
        panel(cycle, scene_look.is_dark, scene_look.is_transparent),
        surroundings(cycle, parts, panel.theme().text),
        view(graphics) {
    vtkRenderer& renderer = view.renderer();
    parts.add_to(renderer);
    surroundings.add_to(renderer);
    add_lights(renderer);
    view.set_samples(look.samples);
    reach = places_reached(cycle, parts, renderer);
    crank_rad = cycle.shown_crank_rad();
    parts.pose(Pose3{}, crank_rad);
  }

  Camera camera(const PictureSize& size) const {
    return nearest_camera(line_of_sight(), kViewAngle_rad, reach.front(), reach, size, kMargin);
  }

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
  std::vector<Point3> reach;  ///< of the whole motion
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
  state_->panel.draw_readings(canvas, sheet, position);
  return canvas;
}

double LinkageScene::shown_crank_rad() const { return state_->cycle.shown_crank_rad(); }

std::unique_ptr<Film> linkage_film(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size,
                                   std::size_t frames) {
  return std::make_unique<LinkageFilm>(scene, model, size, frames);
}

}  // namespace gdtslam
