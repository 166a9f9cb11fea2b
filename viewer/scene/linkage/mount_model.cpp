#include "mount_model.hpp"

#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "gdtslam/core/angle.hpp"
#include "linkage_cycle.hpp"
#include "linkage_parts.hpp"

namespace gdtslam {
namespace {

constexpr Colour kShell = colour_for(0xe9ecef);
constexpr Colour kDeck = colour_for(0x4a525c);
constexpr Colour kTyre = colour_for(0x22252a);
constexpr Colour kHub = colour_for(0xaab1ba);
constexpr Colour kFrame = colour_for(0x707884);
constexpr double kLevelHeight_m = 0.3;
constexpr double kLaser_m = 0.07;

/// Of the robot under a sensor at this height.
struct Body {
  double wheel_m = 0.09;  ///< radius
  double length_m = 0.42;
  double width_m = 0.30;
  double bottom_m = 0.06;
  double top_m = 0.2;
};

Body body_under(double axis_m) {
  // Leaves the linkage its room below the axis; a sensor close to the floor has a flat robot.
  const double share = std::clamp(axis_m / 0.42, 0.2, 1.5);
  return {.wheel_m = 0.09 * share,
          .length_m = 0.42 * share,
          .width_m = 0.30 * share,
          .bottom_m = 0.05 * share,
          .top_m = 0.19 * share};
}

/// An outline of x and z, thick along y.
Mesh plate(const Outline& outline, double front_y, double back_y, double chamfer) {
  Mesh mesh;
  mesh.extrude(outline, front_y, back_y, chamfer);
  return mesh;
}

/// An outline of x and y, from one height to another.
Mesh upright(const Outline& outline, double low_z, double high_z, double chamfer) {
  Mesh mesh;
  mesh.extrude(outline, -high_z, -low_z, chamfer);
  mesh.move({Point3::Zero(), exp_so3(Point3(-0.5 * kPi, 0.0, 0.0))});
  return mesh;
}

void add_wheels(Part& part, const Body& body) {
  const double thick_m = 0.3 * body.wheel_m;
  for (const double side : {-1.0, 1.0}) {
    const double middle_y = side * (0.5 * body.width_m + 0.6 * thick_m);
    const auto wheel = [&](double radius, double half, Colour colour, Finish finish) {
      part.add(plate(circle_outline({0.0, body.wheel_m}, radius, 48), middle_y - half, middle_y + half, 0.25 * half),
               colour, finish);
    };
    wheel(body.wheel_m, 0.5 * thick_m, kTyre, Finish::kPaint);
    wheel(0.62 * body.wheel_m, 0.54 * thick_m, kHub, Finish::kSteel);
    wheel(0.16 * body.wheel_m, 0.62 * thick_m, kTyre, Finish::kPaint);
  }
  Mesh caster;
  caster.ball({-0.38 * body.length_m, 0.0, 0.35 * body.wheel_m}, 0.35 * body.wheel_m);
  part.add(caster, kTyre);
  part.add(upright(circle_outline({-0.38 * body.length_m, 0.0}, 0.22 * body.wheel_m), 0.4 * body.wheel_m,
                   body.bottom_m + 0.2 * body.wheel_m, 0.0),
           kHub, Finish::kSteel);
}

void add_body(Part& part, const Body& body) {
  const Point2 half(0.5 * body.length_m, 0.5 * body.width_m);
  const double round_m = 0.32 * body.width_m;
  part.add(upright(rectangle_outline(-half, half, round_m), body.bottom_m, body.top_m, 0.06 * body.width_m), kShell);
  // A belt in the colour of the laser shows which way the robot is turned by its gap at the back.
  part.add(upright(rectangle_outline(-1.006 * half, 1.006 * half, round_m), 0.62 * body.top_m, 0.7 * body.top_m, 0.0),
           kDeck);
  part.add(upright(rectangle_outline(-0.86 * half, 0.86 * half, 0.8 * round_m), body.top_m - 0.004, body.top_m + 0.004,
                   0.002),
           kDeck);
  // An arrow on the deck: forward.
  const double deck_m = body.top_m + 0.004;
  const double tip = 0.40 * body.length_m;
  const double arrow = 0.09 * body.length_m;
  part.add(upright(polygon_outline({{tip - arrow, -0.8 * arrow}, {tip, 0.0}, {tip - arrow, 0.8 * arrow}}), deck_m,
                   deck_m + 0.002, 0.0),
           ink::kLaser, Finish::kFlat);
}

}  // namespace

struct MountModel::State {
  State(const calib::SweepModel* sweep, const MountLook& mount_look) : look(mount_look) {
    if (sweep != nullptr) {
      mount = sweep->mount;
    } else {
      mount.height_m = kLevelHeight_m;
    }
    if (sweep != nullptr && look.with_linkage) {
      cycle.emplace(*sweep);
      PartSizes sizes = suitable_sizes(sweep->bars);
      sizes.laser_m = std::min(kLaser_m, sizes.laser_m);
      sizes.fan_m = look.fan_m;
      sizes.with_feet = false;
      sizes.is_fan_cut = false;
      linkage.emplace(*sweep, sizes);
    } else {
      lone_laser = laser_part(kLaser_m);
    }
    build_robot();
    if (cycle) crank_rad = cycle->shown_crank_rad();
    if (linkage) linkage->show_fan(look.with_fan);
    move();
  }

  [[nodiscard]] double axis_m() const { return mount.height_m - mount.lever_up_m; }
  [[nodiscard]] Pose3 T_base_axis() const {
    return embed(look.T_base_level, axis_m()) *
           Pose3{{-mount.lever_forward_m, 0.0, 0.0}, Eigen::Quaterniond::Identity()};
  }

  void build_robot() {
    const Body body = body_under(axis_m());
    add_body(robot, body);
    add_wheels(robot, body);
    Part mast;
    add_mast(mast, body);
    mast.move(embed(look.T_base_level));
    for (const auto& actor : mast.actors) masts.actors.push_back(actor);
  }

  /// Two cheeks that carry the axle, the right one with the crank's pivot.
  void add_mast(Part& part, const Body& body) const {
    const double laser_m = linkage ? linkage->sizes().laser_m : kLaser_m;
    const double axis_z = axis_m();
    const double x = -mount.lever_forward_m;
    if (!linkage) {
      const double top_z = axis_z - 0.6 * laser_m;
      if (top_z <= body.top_m) return;
      part.add(
          upright(rectangle_outline({-0.3 * laser_m, -0.3 * laser_m}, {0.3 * laser_m, 0.3 * laser_m}, 0.05 * laser_m),
                  body.top_m, top_z, 0.0),
          kFrame);
      return;
    }
    const double neck_z = std::max(axis_z - 1.05 * laser_m, body.top_m);
    const Point2 half(0.55 * laser_m, 0.634 * laser_m);
    part.add(upright(rectangle_outline(Point2(x, 0.0) - half, Point2(x, 0.0) + half, 0.2 * laser_m), body.top_m - 0.01,
                     neck_z, 0.0),
             kFrame);
    // Between the cradle's plates and the linkage's ground.
    for (const double middle_y : {-0.612 * laser_m, 0.612 * laser_m}) {
      part.add(plate(bar_outline({x, axis_z}, {x, neck_z}, 0.26 * laser_m), middle_y - 0.022 * laser_m,
                     middle_y + 0.022 * laser_m, 0.004 * laser_m),
               kFrame, Finish::kPaint);
    }
  }

  void move() {
    const Pose3 T_map_robot = embed(T_map_base);
    robot.move(T_map_robot);
    masts.move(T_map_robot * embed(look.T_base_level));
    if (linkage) linkage->pose(T_map_robot * T_base_axis(), crank_rad);
    lone_laser.move(T_map_robot * T_base_axis() * T_axis_laser(mount, elevation_rad));
  }

  MountLook look;
  NoddingMount mount;
  std::optional<LinkageCycle> cycle;
  std::optional<LinkageParts> linkage;
  Part robot;
  Part masts;
  Part lone_laser;             ///< of a robot without a linkage,
  double elevation_rad = 0.0;  ///< and where it looks
  Pose2 T_map_base;
  double crank_rad = 0.0;
};

MountModel::MountModel(const calib::SweepModel* model, const MountLook& look)
    : state_(std::make_unique<State>(model, look)) {}

MountModel::~MountModel() = default;

void MountModel::add_to(vtkRenderer& renderer) {
  state_->robot.add_to(renderer);
  state_->masts.add_to(renderer);
  state_->lone_laser.add_to(renderer);
  if (state_->linkage) state_->linkage->add_to(renderer);
}

void MountModel::place(const Pose2& T_map_base) {
  state_->T_map_base = T_map_base;
  state_->move();
}

void MountModel::set_crank(double crank_rad) {
  if (!state_->cycle || !state_->cycle->at(crank_rad)) return;
  state_->crank_rad = crank_rad;
  state_->move();
}

void MountModel::set_elevation(double elevation_rad, bool is_rising) {
  if (!state_->cycle) {
    state_->elevation_rad = elevation_rad;
    state_->move();
    return;
  }
  set_crank(state_->cycle->crank_of(elevation_rad, is_rising, state_->cycle->model().encoder.direction));
}

bool MountModel::has_linkage() const { return state_->cycle.has_value(); }

void MountModel::set_visible(bool is_visible) {
  state_->robot.show(is_visible);
  state_->masts.show(is_visible);
  state_->lone_laser.show(is_visible);
  if (!state_->linkage) return;
  state_->linkage->show(is_visible);
  state_->linkage->show_fan(is_visible && state_->look.with_fan);
}

void MountModel::set_fan_visible(bool is_visible) {
  state_->look.with_fan = is_visible;
  if (state_->linkage) state_->linkage->show_fan(is_visible);
}

Pose3 MountModel::T_map_laser() const {
  double elevation_rad = state_->elevation_rad;
  if (state_->cycle) elevation_rad = calib::elevation_rad(state_->cycle->model(), state_->crank_rad).value_or(0.0);
  return embed(state_->T_map_base) * state_->T_base_axis() * T_axis_laser(state_->mount, elevation_rad);
}

}  // namespace gdtslam
