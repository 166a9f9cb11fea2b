// Walls: their limits, and their boxes.
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {
namespace {

// Written so that a value that is not a number counts as outside.
void require(std::vector<std::string>& faults, bool holds, const std::string& fault) {
  constexpr std::size_t kMostFaults = 100;  // a wall may have a hundred thousand doors
  if (!holds && faults.size() < kMostFaults) {
    faults.push_back(fault);
  }
}

bool is_inside(double value, double low, double high) { return value >= low && value <= high; }

bool is_inside(const Point2& point) {
  return is_inside(point.x(), -kMaxCoordinate_m, kMaxCoordinate_m) &&
         is_inside(point.y(), -kMaxCoordinate_m, kMaxCoordinate_m);
}

void require_upright(std::vector<std::string>& faults, double base_m, double height_m) {
  require(faults, is_inside(base_m, -kMaxCoordinate_m, kMaxCoordinate_m), "base must lie within 1000 m of the origin");
  require(faults, is_inside(height_m, 1e-3, kMaxCoordinate_m), "height must be 1 mm to 1000 m");
}

struct WallLeg {
  Pose2 T_map_leg;  ///< origin at the leg's first point, x along the leg
  double length_m = 0.0;
  double lead_in_m = 0.0;  ///< extension of the leg beyond its ends to close the corners
  double lead_out_m = 0.0;
};

double leg_length(const Wall& wall, std::size_t index) {
  const Point2 along = wall.points_m[(index + 1) % wall.points_m.size()] - wall.points_m[index];
  return std::sqrt(along.x() * along.x() + along.y() * along.y());
}

WallLeg leg_at(const Wall& wall, std::size_t index) {
  const Point2& from = wall.points_m[index];
  const Point2 along = wall.points_m[(index + 1) % wall.points_m.size()] - from;
  const double half_m = 0.5 * wall.thickness_m;
  const bool joins_before = wall.is_closed || index > 0;
  const bool joins_after = wall.is_closed || index + 1 < wall.leg_count();
  return {{from.x(), from.y(), gdtslam::atan2(along.y(), along.x())},
          leg_length(wall, index),
          joins_before ? half_m : 0.0,
          joins_after ? half_m : 0.0};
}

// The part of the leg between two distances along it.
Box make_piece(const Wall& wall, const WallLeg& leg, double from_m, double to_m, double base_m, double height_m) {
  return {.centre_m = leg.T_map_leg * Point2(0.5 * (from_m + to_m), 0.0),
          .size_m = {to_m - from_m, wall.thickness_m},
          .yaw_rad = leg.T_map_leg.theta_rad,
          .base_m = base_m,
          .height_m = height_m};
}

Box make_leaf(const Wall& wall, const WallLeg& leg, const Door& door, const DoorLeaf& leaf) {
  const double hinge_m = leaf.hinge_at_far ? door.from_m + door.width_m : door.from_m;
  const double closed_rad = leaf.hinge_at_far ? kPi : 0.0;
  const double opening_rad = leaf.hinge_at_far ? -leaf.angle_rad : leaf.angle_rad;
  const Pose2 T_map_leaf = leg.T_map_leg * Pose2{hinge_m, 0.0, closed_rad + opening_rad};
  return {.centre_m = T_map_leaf * Point2(0.5 * door.width_m, 0.0),
          .size_m = {door.width_m, leaf.thickness_m},
          .yaw_rad = T_map_leaf.theta_rad,
          .base_m = wall.base_m,
          .height_m = std::min(door.height_m, wall.height_m)};
}

// The openings of all legs, ordered by leg and by distance along it.
std::vector<Door> doors_in_order(const Wall& wall) {
  std::vector<Door> doors = wall.doors;
  std::stable_sort(doors.begin(), doors.end(),
                   [](const Door& a, const Door& b) { return a.leg != b.leg ? a.leg < b.leg : a.from_m < b.from_m; });
  return doors;
}

std::span<const Door> doors_of_leg(const std::vector<Door>& in_order, std::size_t leg) {
  const auto [first, last] = std::equal_range(in_order.begin(), in_order.end(), Door{.leg = leg},
                                              [](const Door& a, const Door& b) { return a.leg < b.leg; });
  return {first, last};
}

void add_leg(std::vector<Box>& boxes, const Wall& wall, std::size_t index, std::span<const Door> doors) {
  const WallLeg leg = leg_at(wall, index);
  double from_m = -leg.lead_in_m;
  for (const Door& door : doors) {
    if (door.from_m > from_m) {
      boxes.push_back(make_piece(wall, leg, from_m, door.from_m, wall.base_m, wall.height_m));
    }
    from_m = door.from_m + door.width_m;
    if (door.height_m < wall.height_m) {
      boxes.push_back(
          make_piece(wall, leg, door.from_m, from_m, wall.base_m + door.height_m, wall.height_m - door.height_m));
    }
    if (door.sill_m > 0.0) {
      boxes.push_back(make_piece(wall, leg, door.from_m, from_m, wall.base_m, std::min(door.sill_m, wall.height_m)));
    }
    if (door.leaf) {
      boxes.push_back(make_leaf(wall, leg, door, *door.leaf));
    }
  }
  const double to_m = leg.length_m + leg.lead_out_m;
  if (to_m > from_m) {
    boxes.push_back(make_piece(wall, leg, from_m, to_m, wall.base_m, wall.height_m));
  }
}

void check_doors(std::vector<std::string>& faults, const Wall& wall, std::size_t leg, std::span<const Door> doors) {
  const double length_m = leg_length(wall, leg);
  double free_from_m = 0.0;
  for (const Door& door : doors) {
    const std::string name = (door.sill_m > 0.0 ? "the window at " : "the door at ") + std::to_string(door.from_m) +
                             " m of leg " + std::to_string(leg);
    require(faults, is_inside(door.width_m, 0.01, kMaxCoordinate_m), name + " must be at least 1 cm wide");
    require(faults, is_inside(door.height_m - door.sill_m, 0.01, kMaxCoordinate_m),
            name + " must be at least 1 cm high");
    require(faults, is_inside(door.sill_m, 0.0, kMaxCoordinate_m), name + " must not have its sill under the wall");
    require(faults, door.from_m >= free_from_m, name + " begins before the leg or overlaps the opening before it");
    require(faults, door.from_m + door.width_m <= length_m,
            name + " ends after the leg, which is " + std::to_string(length_m) + " m long");
    free_from_m = door.from_m + door.width_m;
    if (door.leaf) {
      require(faults, is_inside(door.leaf->angle_rad, -kPi, kPi), name + ": the leaf's angle must be -180 to 180 deg");
      require(faults, is_inside(door.leaf->thickness_m, 1e-3, 1.0), name + ": the leaf must be 1 mm to 1 m thick");
    }
  }
}

}  // namespace

std::vector<std::string> validate(const Box& box) {
  std::vector<std::string> faults;
  require(faults, is_inside(box.centre_m), "centre must lie within 1000 m of the origin");
  require(faults,
          is_inside(box.size_m.x(), 1e-3, kMaxCoordinate_m) && is_inside(box.size_m.y(), 1e-3, kMaxCoordinate_m),
          "size must be 1 mm to 1000 m on each side");
  require(faults, is_inside(box.yaw_rad, -1000.0, 1000.0), "yaw must be a finite angle");
  require_upright(faults, box.base_m, box.height_m);
  return faults;
}

std::vector<std::string> validate(const Cylinder& cylinder) {
  std::vector<std::string> faults;
  require(faults, is_inside(cylinder.centre_m), "centre must lie within 1000 m of the origin");
  require(faults, is_inside(cylinder.radius_m, 1e-3, kMaxCoordinate_m), "radius must be 1 mm to 1000 m");
  require(faults, cylinder.sides >= 3 && cylinder.sides <= 4096, "sides must be 3 to 4096");
  require_upright(faults, cylinder.base_m, cylinder.height_m);
  return faults;
}

std::vector<std::string> validate(const Wall& wall) {
  std::vector<std::string> faults;
  require(faults, wall.points_m.size() >= (wall.is_closed ? 3U : 2U), "points must be at least 2, or 3 when closed");
  require(faults, std::all_of(wall.points_m.begin(), wall.points_m.end(), [](const Point2& p) { return is_inside(p); }),
          "points must lie within 1000 m of the origin");
  require(faults, is_inside(wall.thickness_m, 1e-3, 100.0), "thickness must be 1 mm to 100 m");
  require_upright(faults, wall.base_m, wall.height_m);
  if (!faults.empty()) {
    return faults;
  }
  const std::vector<Door> doors = doors_in_order(wall);
  for (std::size_t leg = 0; leg < wall.leg_count() && faults.empty(); ++leg) {
    require(faults, leg_length(wall, leg) >= 1e-3, "leg " + std::to_string(leg) + " is shorter than 1 mm");
    check_doors(faults, wall, leg, doors_of_leg(doors, leg));
  }
  for (const Door& door : wall.doors) {
    require(
        faults, door.leg < wall.leg_count(),
        "a door names leg " + std::to_string(door.leg) + "; the last leg is " + std::to_string(wall.leg_count() - 1));
  }
  return faults;
}

std::vector<Box> boxes_of(const Wall& wall) {
  std::vector<Box> boxes;
  const std::vector<Door> doors = doors_in_order(wall);
  for (std::size_t leg = 0; leg < wall.leg_count(); ++leg) {
    add_leg(boxes, wall, leg, doors_of_leg(doors, leg));
  }
  return boxes;
}

}  // namespace gdtslam::sim
