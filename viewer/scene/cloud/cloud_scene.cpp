#include "gdtslam/viewer/cloud_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloud_path.hpp"
#include "cloud_points.hpp"
#include "cloud_values.hpp"
#include "gdtslam/core/error.hpp"
#include "viewer/graphics/offscreen_view.hpp"
#include "viewer/scene/linkage/mount_model.hpp"

namespace gdtslam {
namespace {

constexpr double kPathWidthShare = 1.0 / 260.0;  // in picture heights
constexpr double kLeastPathWidth_px = 1.6;
constexpr double kLeastPathWidth_m = 0.03;
constexpr double kLargestPathWidth_m = 2.0;
// A camera this near looks at the robot: walls between them are opened. A farther camera does not see through them.
constexpr double kNearRobot_m = 10.0;
constexpr double kRobotMiddle_m = 0.2;
constexpr double kKept_m = 0.45;  // around its middle

// A point is as large as the gaps around it, up to a limit.
constexpr double kCoverage = 1.7;  // diameters per mean distance of neighbours, so that discs overlap
constexpr double kLeastPoint_px = 1.5;
constexpr double kLargestPointShare = 1.0 / 16.0;  // in picture heights
constexpr double kNearPointShare = 1.0 / 110.0;    // if the camera is near the robot

constexpr double kLeastShareFramed = 0.99;  // share of the drawn points within the box that a camera shows

// The box of surfaces: a few far beams through a door or a window should not make everything else small. It must
// contain nearly all drawn points; in an open or sparse cloud, whose far points are no outliers, it does not, and the
// box of all points is used.
Bounds bounds_of_surfaces(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn,
                          const CloudGaps& gaps, const Bounds& of_all) {
  std::vector<std::uint32_t> dense;
  for (const std::uint32_t k : drawn) {
    if (!gaps.is_alone(cloud[k])) dense.push_back(k);
  }
  if (dense.empty()) return of_all;
  const Bounds box = robust_bounds(cloud, dense);
  const auto held = std::count_if(drawn.begin(), drawn.end(), [&](std::uint32_t k) {
    return box.holds({cloud[k].x_m, cloud[k].y_m, cloud[k].z_m});
  });
  return static_cast<double>(held) >= kLeastShareFramed * static_cast<double>(drawn.size()) ? box : of_all;
}

}  // namespace

struct CloudScene::State {
  State(const GraphicsContext& graphics, const CloudLook& with)
      : look(with), view(graphics), path(view.renderer(), with.is_dark) {
    view.set_background(look.is_dark ? ink::kNight : ink::kPage, look.is_transparent);
    view.set_eye_dome(look.with_eye_dome);
    view.set_samples(look.samples);
    view.set_layer(&points);
  }

  [[nodiscard]] double floor_m(const Point2& at) const {
    return surfaces.floor ? height_m(surfaces.floor->plane, at) : 0.0;
  }

  /// Hides the robot without a pose; builds it if the model has changed.
  void set_robot(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model, double elevation_rad) {
    if (T_map_base && (!robot || robot_model != model)) {
      if (robot) robot->set_visible(false);
      robot = std::make_unique<MountModel>(model);
      robot_model = model;
      robot->add_to(view.renderer());
    }
    if (!robot) return;
    robot->set_visible(T_map_base.has_value());
    if (!T_map_base) return;
    robot->place(*T_map_base);
    robot->set_elevation(elevation_rad);
  }

  CloudLook look;
  CloudPoints points;
  OffscreenView view;
  CloudPath path;
  std::unique_ptr<MountModel> robot;
  const calib::SweepModel* robot_model = nullptr;
  std::optional<Point3> robot_at;
  LevelSurfaces surfaces;
  Bounds cloud_bounds;
  Bounds bounds;
  ColourScale scale;

  void update_bounds() {
    bounds = cloud_bounds;
    if (path.bounds().is_empty()) return;
    bounds.add(path.bounds().lowest);
    bounds.add(path.bounds().highest);
  }
};

CloudScene::CloudScene(const GraphicsContext& graphics, const CloudLook& look)
    : state_(std::make_unique<State>(graphics, look)) {}
CloudScene::~CloudScene() = default;

void CloudScene::set_cloud(std::span<const CloudPoint> cloud, std::span<const float> distances_m) {
  State& s = *state_;
  if (s.look.colour == CloudColour::kDistance && distances_m.size() != cloud.size()) {
    throw InputError("colours by distance need one distance for each of the " + std::to_string(cloud.size()) +
                     " points, not " + std::to_string(distances_m.size()));
  }
  s.surfaces = sampled_level_surfaces(cloud);
  std::vector<std::uint32_t> drawn = drawn_points(cloud, s.surfaces, s.look);
  s.cloud_bounds = robust_bounds(cloud, drawn);
  const CloudValues values(s.look.colour, cloud, distances_m);
  s.scale = colour_scale(s.look, values, drawn);
  if (s.look.colour == CloudColour::kHeight && !s.look.most && !s.look.with_ceiling && s.surfaces.ceiling) {
    // The scale ends at the hidden ceiling: else the rims of all walls, the most visible parts, have the scale's last
    // colour.
    const Point3 middle = s.cloud_bounds.centre();
    s.scale.most = std::max(s.scale.most, height_m(s.surfaces.ceiling->plane, {middle.x(), middle.y()}));
  }
  const ColourMap& map = colour_map(s.scale.colour_map);
  const CloudGaps gaps(cloud, drawn, (s.cloud_bounds.highest - s.cloud_bounds.lowest).maxCoeff());
  s.cloud_bounds = bounds_of_surfaces(cloud, drawn, gaps, s.cloud_bounds);
  const bool is_plain = s.look.colour == CloudColour::kPlain;
  const Colour plain = plain_colour(s.look);
  s.points.set(cloud, std::move(drawn), [&](std::uint32_t k) {
    return CloudPoints::Look{.colour = is_plain ? plain : colour_at(s.scale, map, values.at(k)),
                             .diameter_m = kCoverage * gaps.at_m(cloud[k])};
  });
  s.update_bounds();
}

void CloudScene::set_trajectory(const Trajectory& trajectory) {
  State& s = *state_;
  s.path.set(trajectory, [&s](const Point2& at) { return s.floor_m(at); });
  s.update_bounds();
}

void CloudScene::set_robot(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model,
                           double elevation_rad) {
  State& s = *state_;
  s.set_robot(T_map_base, model, elevation_rad);
  s.robot_at.reset();
  if (!T_map_base) return;
  const Point2 at = T_map_base->translation();
  s.robot_at = Point3(at.x(), at.y(), s.floor_m(at) + kRobotMiddle_m);
}

void CloudScene::show_until(double stamp_s) {
  state_->points.show_until(stamp_s);
  state_->path.show_until(stamp_s);
}

const Bounds& CloudScene::bounds() const { return state_->bounds; }
const ColourScale& CloudScene::scale() const { return state_->scale; }
std::uint64_t CloudScene::points_drawn() const { return state_->points.shown(); }

RgbaImage CloudScene::render(const Camera& camera, const PictureSize& size) {
  State& s = *state_;
  const bool is_near = s.robot_at && !camera.is_parallel && (camera.eye - *s.robot_at).norm() < kNearRobot_m;
  s.points.set_sizes({.least_px = kLeastPoint_px,
                      .largest_px = std::max(2.0, (is_near ? kNearPointShare : kLargestPointShare) * size.height),
                      .samples = s.look.samples});
  s.points.keep_in_view(is_near ? std::optional(KeptInView{*s.robot_at, kKept_m}) : std::nullopt);
  const double scale_px = pixels_per_metre(camera, size, camera.target);
  const double width_m = std::max(kLeastPathWidth_px, kPathWidthShare * size.height) / std::max(scale_px, 1e-6);
  s.path.prepare(std::clamp(width_m, kLeastPathWidth_m, kLargestPathWidth_m));
  return s.view.render(camera, size);
}

}  // namespace gdtslam
