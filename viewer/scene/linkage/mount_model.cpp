#include "mount_model.hpp"

#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr Colour kShell = colour_for(0xe9ecef);
constexpr Colour kDeck = colour_for(0x4a525c);
constexpr Colour kTyre = colour_for(0x22252a);
constexpr Colour kHub = colour_for(0xaab1ba);
constexpr Colour kFrame = colour_for(0x707884);
constexpr double kLevelHeight_m = 0.3;
constexpr double kLaser_m = 0.07;

/// Dimensions of the robot's body under a sensor at this height.
struct Body {
  double wheel_m = 0.09;  ///< radius
  double length_m = 0.42;
  double width_m = 0.30;
  double bottom_m = 0.06;
  double top_m = 0.2;
};

Body body_under(double axis_m) {
  // Leaves room for the linkage below the axis; a low sensor gives a flat robot.
  const double share = std::clamp(axis_m / 0.42, 0.2, 1.5);
  return {.wheel_m = 0.09 * share,
          .length_m = 0.42 * share,
          .width_m = 0.30 * share,
          .bottom_m = 0.05 * share,
          .top_m = 0.19 * share};
}

void add_box(Part& part, const RoundedBox& box, double low_z, double high_z, Colour colour) {
  part.add(upright(box.corners(), box.radius, low_z, high_z), colour);
}

void add_wheels(Part& part, const Body& body) {
  const double half_m = 0.15 * body.wheel_m;
  for (const double side : {-1.0, 1.0}) {
    const double middle_y = side * (0.5 * body.width_m + 1.2 * half_m);
    const Point2 axle(0.0, body.wheel_m);
    part.add(extruded({axle}, body.wheel_m, middle_y - half_m, middle_y + half_m), kTyre);
    part.add(extruded({axle}, 0.62 * body.wheel_m, middle_y - 1.08 * half_m, middle_y + 1.08 * half_m), kHub,
             Finish::kSteel);
  }
  const double caster_m = 0.35 * body.wheel_m;
  part.add(ball({-0.38 * body.length_m, 0.0, caster_m}, caster_m), kTyre);
  part.add(upright({{-0.38 * body.length_m, 0.0}}, 0.22 * body.wheel_m, 0.4 * body.wheel_m,
                   body.bottom_m + 0.2 * body.wheel_m),
           kHub, Finish::kSteel);
}

void add_body(Part& part, const Body& body) {
  const Point2 half(0.5 * body.length_m, 0.5 * body.width_m);
  const double round_m = 0.32 * body.width_m;
  const double deck_m = body.top_m + 0.004;
  add_box(part, {-half, half, round_m}, body.bottom_m, body.top_m, kShell);
  add_box(part, {-1.006 * half, 1.006 * half, round_m}, 0.62 * body.top_m, 0.7 * body.top_m, kDeck);
  add_box(part, {-0.86 * half, 0.86 * half, 0.8 * round_m}, body.top_m - 0.004, deck_m, kDeck);
  // An arrow on the deck that points forward.
  const double tip = 0.40 * body.length_m;
  const double arrow = 0.09 * body.length_m;
  part.add(upright({{tip - arrow, -0.8 * arrow}, {tip, 0.0}, {tip - arrow, 0.8 * arrow}}, 0.0, deck_m, deck_m + 0.002),
           ink::kLaser, Finish::kFlat);
}

}  // namespace

MountModel::MountModel(const calib::SweepModel* model, bool with_linkage, const Pose2& T_base_level)
    : T_base_level_(T_base_level) {
  if (model != nullptr) {
    mount_ = model->mount;
  } else {
    mount_.height_m = kLevelHeight_m;
  }
  if (model != nullptr && with_linkage) {
    cycle_.emplace(*model);
    crank_rad_ = cycle_->shown_crank_rad();
    PartSizes sizes = suitable_sizes(model->bars);
    sizes.laser_m = std::min(kLaser_m, sizes.laser_m);
    sizes.fan_m = 0.0;
    sizes.with_feet = false;
    linkage_.emplace(*model, sizes);
  } else {
    lone_laser_ = laser_part(kLaser_m);
  }
  const Body body = body_under(axis_m());
  add_body(robot_, body);
  add_wheels(robot_, body);
  add_mast(body.top_m);
  move();
}

Pose3 MountModel::T_base_axis() const {
  return embed(T_base_level_, axis_m()) * Pose3{{-mount_.lever_forward_m, 0.0, 0.0}, Eigen::Quaterniond::Identity()};
}

void MountModel::add_mast(double body_top_m) {
  const double laser_m = linkage_ ? linkage_->sizes().laser_m : kLaser_m;
  const double axis_z = axis_m();
  const double x = -mount_.lever_forward_m;
  const auto post = [&](const Point2& half, double radius) {
    return RoundedBox{Point2(x, 0.0) - half, Point2(x, 0.0) + half, radius};
  };
  if (!linkage_) {
    const double top_z = axis_z - 0.6 * laser_m;
    const double half_m = 0.3 * laser_m;
    if (top_z > body_top_m) add_box(mast_, post({half_m, half_m}, 0.05 * laser_m), body_top_m, top_z, kFrame);
    return;
  }
  const double neck_z = std::max(axis_z - 1.05 * laser_m, body_top_m);
  add_box(mast_, post({0.55 * laser_m, 0.634 * laser_m}, 0.2 * laser_m), body_top_m - 0.01, neck_z, kFrame);
  // Between the cradle's plates and the linkage's ground.
  for (const double middle_y : {-0.612 * laser_m, 0.612 * laser_m}) {
    mast_.add(
        extruded({{x, axis_z}, {x, neck_z}}, 0.26 * laser_m, middle_y - 0.022 * laser_m, middle_y + 0.022 * laser_m),
        kFrame);
  }
}

void MountModel::move() {
  const Pose3 T_map_robot = embed(T_map_base_);
  robot_.move(T_map_robot);
  mast_.move(T_map_robot * embed(T_base_level_));
  if (linkage_) linkage_->pose(T_map_robot * T_base_axis(), crank_rad_);
  lone_laser_.move(T_map_robot * T_base_axis() * T_axis_laser(mount_, elevation_rad_));
}

void MountModel::add_to(vtkRenderer& renderer) {
  for (const Part* part : {&robot_, &mast_, &lone_laser_}) part->add_to(renderer);
  if (linkage_) linkage_->add_to(renderer);
}

void MountModel::place(const Pose2& T_map_base) {
  T_map_base_ = T_map_base;
  move();
}

void MountModel::set_crank(double crank_rad) {
  if (!cycle_ || !cycle_->at(crank_rad)) return;
  crank_rad_ = crank_rad;
  move();
}

void MountModel::set_elevation(double elevation_rad, bool is_rising) {
  if (cycle_) {
    set_crank(cycle_->crank_of(elevation_rad, is_rising, cycle_->model().encoder.direction));
    return;
  }
  elevation_rad_ = elevation_rad;
  move();
}

void MountModel::set_visible(bool is_visible) {
  for (Part* part : {&robot_, &mast_, &lone_laser_}) part->show(is_visible);
  if (linkage_) linkage_->show(is_visible);
}

Pose3 MountModel::T_map_laser() const {
  double elevation_rad = elevation_rad_;
  if (cycle_) elevation_rad = calib::elevation_rad(cycle_->model(), crank_rad_).value_or(0.0);
  return embed(T_map_base_) * T_base_axis() * T_axis_laser(mount_, elevation_rad);
}

}  // namespace gdtslam
