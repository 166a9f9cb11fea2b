#include "scanning_scene.hpp"

#include <vtkActor.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "scanning_beams.hpp"
#include "viewer/graphics/offscreen_view.hpp"
#include "viewer/scene/cloud/cloud_colours.hpp"
#include "viewer/scene/cloud/cloud_density.hpp"
#include "viewer/scene/cloud/cloud_level.hpp"
#include "viewer/scene/cloud/cloud_path.hpp"
#include "viewer/scene/cloud/cloud_points.hpp"
#include "viewer/scene/linkage/mount_model.hpp"

namespace gdtslam {
namespace {

constexpr double kCube_m = 0.08;          ///< in which the density of points is measured
constexpr double kMostDiameter_m = 0.03;  ///< of a point that lies alone
constexpr double kFades_s = 0.3;
constexpr double kPathWidth_m = 0.014;
constexpr double kGridStep_m = 1.0;
constexpr int kMostGridLines = 120;

/// Lines a metre apart on the floor, under all that is shown.
Mesh floor_grid(const Bounds& bounds) {
  Mesh grid;
  const auto round_down = [](double value) { return kGridStep_m * (std::floor(value / kGridStep_m) - 1.0); };
  const Point2 low(round_down(bounds.lowest.x()), round_down(bounds.lowest.y()));
  const Point2 high(-round_down(-bounds.highest.x()), -round_down(-bounds.highest.y()));
  const Point2 count = (high - low) / kGridStep_m;
  if (count.x() + count.y() > kMostGridLines) return grid;
  constexpr double kHalf_m = 0.006;
  for (int i = 0; i <= static_cast<int>(std::lround(count.x())); ++i) {
    const double x = low.x() + kGridStep_m * i;
    grid.band({{x - kHalf_m, low.y(), 0.0}, {x - kHalf_m, high.y(), 0.0}},
              {{x + kHalf_m, low.y(), 0.0}, {x + kHalf_m, high.y(), 0.0}});
  }
  for (int i = 0; i <= static_cast<int>(std::lround(count.y())); ++i) {
    const double y = low.y() + kGridStep_m * i;
    grid.band({{low.x(), y - kHalf_m, 0.0}, {high.x(), y - kHalf_m, 0.0}},
              {{low.x(), y + kHalf_m, 0.0}, {high.x(), y + kHalf_m, 0.0}});
  }
  return grid;
}

}  // namespace

struct ScanningScene::State {
  State(const GraphicsContext& graphics, const ScanningTrack& with_track, const calib::SweepModel& model,
        bool has_linkage, const Trajectory& trajectory, const CloudLook& with_look)
      : track(with_track),
        look(with_look),
        view(graphics),
        points(view.renderer()),
        path(view.renderer(), with_look.is_dark),
        beams(view.renderer()),
        robot(&model, {.with_linkage = has_linkage, .T_base_level = {track.sensor_forward_m(model.mount), 0.0, 0.0}}) {
    view.set_background(look.is_dark ? ink::kNight : ink::kPage, look.is_transparent);
    view.set_eye_dome(look.with_eye_dome);
    view.set_samples(look.samples);
    add_lights(view.renderer());
    robot.add_to(view.renderer());
    set_points();
    path.set(trajectory, [](const Point2&) { return 0.0; });
  }

  void set_points() {
    const std::span<const CloudPoint> cloud = track.points();
    const LevelSurfaces surfaces = level_surfaces_of(cloud);
    std::vector<std::uint32_t> drawn = drawn_points(cloud, surfaces, look);
    Bounds bounds = robust_bounds(cloud, drawn);
    const CloudValues values(look.colour, cloud, {});
    scale = colour_scale(look, values, drawn);
    const ColourMap& map = colour_map(scale.colour_map);
    const bool is_plain = look.colour == CloudColour::kPlain;
    const CloudDensity density(cloud, drawn, kCube_m);
    points.set(cloud, std::move(drawn), [&](std::uint32_t k) {
      return CloudPoints::Dot{.colour = is_plain ? plain_colour(look) : colour_at(scale, map, values.at(k)),
                              .diameter_m = static_cast<float>(
                                  std::min(1.5 * static_cast<double>(density.spacing_m(cloud[k])), kMostDiameter_m))};
    });
    for (const double stamp_s : {track.from_s(), track.to_s()}) {
      const Pose2 pose = track.T_map_base(stamp_s);
      bounds.add({pose.x_m, pose.y_m, 0.0});
    }
    const auto grid = actor_of(floor_grid(bounds), look.is_dark ? colour_for(0x2a3039) : ink::kEdge, Finish::kFlat);
    view.renderer().AddActor(grid);
  }

  const ScanningTrack& track;
  CloudLook look;
  OffscreenView view;
  CloudPoints points;
  CloudPath path;
  ScanningBeams beams;
  MountModel robot;
  ColourScale scale;
};

ScanningScene::ScanningScene(const GraphicsContext& graphics, const ScanningTrack& track,
                             const calib::SweepModel& model, bool has_linkage, const Trajectory& trajectory,
                             const CloudLook& look)
    : state_(std::make_unique<State>(graphics, track, model, has_linkage, trajectory, look)) {}

ScanningScene::~ScanningScene() = default;

void ScanningScene::show(double stamp_s, double crank_rad) {
  State& s = *state_;
  s.points.show_until(stamp_s);
  s.path.show_until(stamp_s);
  s.robot.place(s.track.T_map_base(stamp_s));
  if (s.robot.has_linkage()) {
    s.robot.set_crank(crank_rad);
  } else {
    s.robot.set_elevation(s.track.elevation_rad(stamp_s));
  }
  const Point3 sensor_m = s.robot.T_map_laser().translation_m;
  s.points.keep_in_view(Point3(sensor_m.x(), sensor_m.y(), 0.5 * sensor_m.z()));
  s.beams.set_scan(sensor_m, s.track.last_scan(stamp_s));
  s.beams.set_fresh(sensor_m, s.track.measured_between(stamp_s - kFades_s, stamp_s),
                    {.now_s = stamp_s, .fades_s = kFades_s, .size_px = 2.0 * s.look.samples});
}

std::uint64_t ScanningScene::points_drawn() const { return state_->points.shown(); }
const ColourScale& ScanningScene::scale() const { return state_->scale; }
Pose3 ScanningScene::T_map_laser() const { return state_->robot.T_map_laser(); }

RgbaImage ScanningScene::render(const Camera& camera, const PictureSize& size) {
  State& s = *state_;
  s.points.set_sizes({.fixed_px = s.look.point_px,
                      .least_px = 1.0,
                      .largest_px = std::max(2.0, size.height / 60.0),
                      .samples = s.look.samples},
                     camera, size);
  s.path.prepare(kPathWidth_m);
  return s.view.render(camera, size);
}

}  // namespace gdtslam
