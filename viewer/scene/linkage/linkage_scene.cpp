#include "gdtslam/viewer/linkage_scene.hpp"

#include <vtkActor.h>
#include <vtkLight.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "engine/drawing/plots/linkage_drawing.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "linkage_parts.hpp"
#include "viewer/graphics/offscreen_view.hpp"

namespace gdtslam {
namespace {

/// View from behind and above the right side: the fan of beams is never seen edge-on between level and upright.
constexpr double kAzimuth_rad = -0.30;
constexpr double kHeight_rad = 0.21;
constexpr double kViewAngle_rad = 0.34;
constexpr double kMargin = 0.05;  ///< share of the picture's sides

Point3 line_of_sight() {
  const SinCos<double> azimuth = sin_cos(kAzimuth_rad);
  const SinCos<double> height = sin_cos(kHeight_rad);
  return {-azimuth.sin * height.cos, azimuth.cos * height.cos, -height.sin};
}

/// Corners of the boxes around all visible parts at many positions of the cycle.
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

Point3 at_layer(const Point2& place, double y) { return {place.x(), y, place.y()}; }

/// A path in dashes of about `dash_m` with equal gaps.
Mesh dashed(const std::vector<Point3>& path, double radius, double dash_m) {
  std::vector<std::vector<Point3>> dashes(1);
  double length_m = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) length_m += (path[i] - path[i - 1]).norm();
    if (std::fmod(length_m, 2.0 * dash_m) < dash_m) {
      dashes.back().push_back(path[i]);
    } else if (!dashes.back().empty()) {
      dashes.emplace_back();
    }
  }
  return tubes(dashes, radius);
}

/// Static surroundings of a moving linkage in the frame of the axis: paths of its joints, the coupler's curve, the
/// laser's sweep, dead points.
class LinkageSurroundings {
 public:
  /// `marks` is the colour of the dead points.
  LinkageSurroundings(const calib::LinkageCycle& cycle, const LinkageParts& parts, Colour marks)
      : thin_m_(0.085 * parts.sizes().bar_m),
        sweep_m_(parts.sizes().fan_m),
        sweep_y_(parts.layer_y(0) + parts.sizes().bar_m) {
    add_sweep(cycle);
    add_paths(cycle, parts);
    for (const calib::LinkagePosition* dead_point : {&cycle.begin(), &cycle.end()}) {
      still_.add(ball(at_layer(dead_point->joints[2], parts.layer_y(1)), 0.55 * parts.sizes().bar_m), marks);
    }
  }

  void add_to(vtkRenderer& renderer) const { still_.add_to(renderer); }
  /// Position on the rim of the laser's sweep for a label.
  [[nodiscard]] Point3 sweep_rim(double elevation_rad, double share) const {
    return at_layer(share * sweep_m_ * calib::unit_at(elevation_rad), sweep_y_);
  }

 private:
  void add_paths(const calib::LinkageCycle& cycle, const LinkageParts& parts) {
    std::vector<Point3> curve;
    std::vector<Point3> arc;
    std::vector<Point3> circle;
    for (const calib::LinkagePosition& position : cycle.positions()) {
      curve.push_back(at_layer(position.middle, parts.layer_y(3)));
      arc.push_back(at_layer(position.joints[2], parts.layer_y(1)));
      circle.push_back(at_layer(position.joints[1], parts.layer_y(2)));
    }
    still_.add(tubes({curve}, 1.5 * thin_m_), ink::kCurve);
    const double dash_m = 0.5 * parts.sizes().bar_m;
    // Only the lift's part, because the return repeats it.
    const auto lift = static_cast<std::size_t>(static_cast<double>(arc.size() - 1) *
                                               std::fabs(cycle.lift_span_rad() / cycle.span_rad()));
    arc.resize(std::min(arc.size(), lift + 1));
    still_.add(dashed(arc, thin_m_, dash_m), ink::kRocker);
    still_.add(dashed(circle, thin_m_, dash_m), ink::kCrank);
  }

  void add_sweep(const calib::LinkageCycle& cycle) {
    constexpr int kSteps = 96;
    constexpr double kClearOfLaser = 0.24;
    const double from_rad = cycle.lowest_rad();
    const double to_rad = std::min(cycle.highest_rad(), from_rad + kTwoPi);
    std::vector<Point3> hub;
    std::vector<Point3> rim;
    for (int i = 0; i <= kSteps; ++i) {
      const double elevation_rad = from_rad + (to_rad - from_rad) * i / kSteps;
      hub.push_back(sweep_rim(elevation_rad, kClearOfLaser));
      rim.push_back(sweep_rim(elevation_rad, 1.0));
    }
    still_.add(band(hub, rim), ink::kLaser, Finish::kFlat, 0.10);
    if (cycle.sweeps_all_around()) return;
    for (const double elevation_rad : {from_rad, to_rad}) {
      std::vector<Point3> edge;
      for (int i = 0; i <= kSteps; ++i) {
        edge.push_back(sweep_rim(elevation_rad, kClearOfLaser + (1.0 - kClearOfLaser) * i / kSteps));
      }
      still_.add(dashed(edge, 0.8 * thin_m_, 0.035 * sweep_m_), ink::kLaser, Finish::kFlat);
    }
  }

  double thin_m_;
  double sweep_m_;
  double sweep_y_;
  Part still_;
};

class LinkageFilm : public Film {
 public:
  LinkageFilm(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size, std::size_t frames)
      : scene_(scene), cycle_(model), size_(size), frames_(frames) {}
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
      const std::optional<Point2> rim = project(seen_from, size, surroundings.sweep_rim(elevation_rad, 1.0));
      const std::optional<Point2> inner = project(seen_from, size, surroundings.sweep_rim(elevation_rad, 0.9));
      if (!rim || !inner) continue;
      const Point2& corner = sheet.scene.corner;
      panel.draw_sweep_label(canvas, sheet, corner + *rim, corner + *inner, elevation_rad);
    }
  }

  LinkageLook look;
  calib::LinkageCycle cycle;
  LinkageParts parts;
  LinkagePanel panel;
  LinkageSurroundings surroundings;
  OffscreenView view;
  std::vector<Point3> reach;  ///< corners of the whole motion
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

void add_lights(vtkRenderer& renderer) {
  renderer.AutomaticLightCreationOff();
  const auto add = [&](double x, double y, double z, double intensity) {
    const auto light = vtkSmartPointer<vtkLight>::New();
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0.0, 0.0, 0.0);
    light->SetIntensity(intensity);
    renderer.AddLight(light);
  };
  add(-0.7, 1.0, 0.9, 0.75);
  add(0.9, 0.1, 0.8, 0.25);
  add(0.0, 0.0, 1.0, 0.25);
}

}  // namespace gdtslam
