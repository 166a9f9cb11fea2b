#include "gdtslam/viewer/linkage_scene.hpp"

#include <fmt/format.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "linkage_cycle.hpp"
#include "linkage_panel.hpp"
#include "linkage_parts.hpp"
#include "linkage_surroundings.hpp"
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

struct Extent {
  Point2 lowest{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Point2 highest{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
};

Extent seen_extent(const Camera& camera, const PictureSize& size, const std::vector<Point3>& places) {
  Extent extent;
  for (const Point3& place : places) {
    const std::optional<Seen> seen = pixel_of(camera, size, place);
    if (!seen) continue;
    extent.lowest = extent.lowest.cwiseMin(Point2(seen->x_px, seen->y_px));
    extent.highest = extent.highest.cwiseMax(Point2(seen->x_px, seen->y_px));
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
    const Extent extent = seen_extent(camera, size, places);
    const double px_per_m = pixels_per_metre(camera, size, camera.target);
    const double margin_px = kMargin * std::min(size.width, size.height);
    const Point2 middle = 0.5 * (extent.lowest + extent.highest);
    camera.target +=
        (middle.x() - 0.5 * size.width) / px_per_m * right - (middle.y() - 0.5 * size.height) / px_per_m * up;
    const Point2 room(size.width - 2.0 * margin_px, size.height - 2.0 * margin_px);
    const Point2 need = extent.highest - extent.lowest;
    distance_m *= std::max(need.x() / room.x(), need.y() / room.y());
  }
  camera.eye = camera.target + distance_m * back;
  return camera;
}

std::string degrees_text(double angle_rad) {
  const double rounded_deg = std::round(10.0 * deg_from_rad(angle_rad)) / 10.0;
  return fmt::format("{:.1f}°", rounded_deg == 0.0 ? 0.0 : rounded_deg);
}

}  // namespace

struct LinkageScene::State {
  State(const GraphicsContext& graphics, const calib::SweepModel& model, const LinkageLook& scene_look)
      : look(scene_look),
        cycle(model),
        sizes(suitable_sizes(model.bars)),
        parts(model, sizes),
        surroundings(cycle, parts, scene_look.is_dark ? kDarkTheme.text : kLightTheme.text),
        panel(cycle, scene_look),
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

  /// Where the laser looks at both ends of its sweep, beyond the rim.
  void draw_sweep_labels(Canvas& canvas, const LinkageSheet& sheet) const {
    const PictureSize size = sheet.scene_size();
    const Camera seen_from = camera(size);
    if (cycle.sweeps_all_around()) return;
    for (const double elevation_rad : {cycle.lowest_rad(), cycle.highest_rad()}) {
      const std::optional<Seen> rim = pixel_of(seen_from, size, surroundings.sweep_rim(elevation_rad, 1.0));
      const std::optional<Seen> inner = pixel_of(seen_from, size, surroundings.sweep_rim(elevation_rad, 0.9));
      if (!rim || !inner) continue;
      const Point2 away = Point2(rim->x_px - inner->x_px, rim->y_px - inner->y_px).normalized();
      const double text = 1.05 * sheet.text;
      const bool is_side = std::fabs(away.x()) > 0.6;
      const std::string words = degrees_text(elevation_rad);
      const double width = text_width(words, text, true);
      // By its left end, which keeps it within the card where the rim comes close to the edge.
      const double share = !is_side ? 0.5 : (away.x() > 0.0 ? 0.0 : 1.0);
      const double left = rim->x_px + 0.6 * text * away.x() - share * width;
      const double drop = is_side ? 0.35 : (away.y() < 0.0 ? -0.4 : 1.2);
      const Point2 at = sheet.scene.corner +
                        Point2(std::clamp(left, 0.4 * text, std::max(0.4 * text, size.width - width - 0.4 * text)),
                               rim->y_px + drop * text);
      canvas.text(at, words,
                  {.size = text,
                   .colour = look.is_dark ? panel.theme().curve(4) : ink::kLaserText,
                   .is_bold = true,
                   .has_halo = true,
                   .halo = panel.theme().card});
    }
  }

  LinkageLook look;
  LinkageCycle cycle;
  PartSizes sizes;
  LinkageParts parts;
  LinkageSurroundings surroundings;
  LinkagePanel panel;
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
  const LinkageSheet sheet = sheet_for(size, state_->look.with_panel);
  const PictureSize scene_size = sheet.scene_size();
  const auto image = std::make_shared<const RgbaImage>(render(crank_rad, scene_size));
  const std::string& name = state_->cycle.model().name;
  Canvas canvas(size.width, size.height, "Linkage " + (name.empty() ? "in motion" : name));
  const bool has_panel = sheet.figures.width > 0.0;
  if (has_panel) state_->panel.draw_ground(canvas, sheet);
  canvas.picture(sheet.scene.corner, scene_size.width, scene_size.height, image);
  if (!has_panel) return canvas;
  state_->draw_sweep_labels(canvas, sheet);
  const LinkagePosition position = state_->cycle.at(state_->crank_rad).value_or(state_->cycle.begin());
  state_->panel.draw_read_outs(canvas, sheet, position);
  return canvas;
}

double LinkageScene::shown_crank_rad() const { return state_->cycle.shown_crank_rad(); }

Point2 LinkageScene::joint_px(std::size_t joint, double crank_rad, const PictureSize& size) const {
  const std::optional<LinkagePosition> position = state_->cycle.at(crank_rad);
  const double shown_rad = position ? crank_rad : state_->crank_rad;
  const LinkagePosition at = position ? *position : state_->cycle.at(shown_rad).value_or(state_->cycle.begin());
  const std::optional<Seen> seen =
      pixel_of(state_->camera(size), size, state_->parts.joints(shown_rad, at.pose).at(joint));
  return seen ? Point2(seen->x_px, seen->y_px) : Point2::Zero();
}

}  // namespace gdtslam
