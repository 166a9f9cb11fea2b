// Parts of a simulated world: walls with doors and windows, boxes, cylinders, imported meshes, and a floor with ramps,
// plates and sills; all become triangles.
// Frame: map (x right, y up, z upwards, floor usually at z = 0); metres and radians. Thread-safe, linear in the parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gdtslam/core/pose.hpp"

namespace gdtslam::sim {

using Vec3 = Eigen::Vector3d;

/// Largest absolute coordinate of a scene. The padding of the ray caster's boxes depends on this limit.
inline constexpr double kMaxCoordinate_m = 1000.0;
/// Scenes with more triangles are refused.
inline constexpr std::size_t kMaxTriangles = 8'000'000;

/// Indexed triangles in the order of their parts.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t triangle) const {
    const std::array<std::uint32_t, 3>& t = triangles[triangle];
    return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
  }
};

/// An upright cuboid, rotated about its centre.
struct Box {
  Point2 centre_m{0.0, 0.0};
  Point2 size_m{1.0, 1.0};
  double yaw_rad = 0.0;
  double base_m = 0.0;  ///< height of its lower side
  double height_m = 1.0;
};

/// An upright cylinder, approximated by a prism with corners on the circle.
struct Cylinder {
  Point2 centre_m{0.0, 0.0};
  double radius_m = 0.1;
  double base_m = 0.0;
  double height_m = 1.0;
  int sides = 32;
};

/// The wing of a door, hinged at one jamb in the middle of the wall's thickness.
struct DoorLeaf {
  double angle_rad = 0.0;     ///< 0: shut; positive: opens to the left of the leg's direction
  bool hinge_at_far = false;  ///< the hinge is at the jamb further along the leg
  double thickness_m = 0.04;
};

/// A gap in one leg of a wall. The wall continues above a gap that is lower than the wall, and below a window's sill.
struct Door {
  std::size_t leg = 0;  ///< leg i goes from point i to point i + 1
  double from_m = 0.0;  ///< along the leg, from its first point
  double width_m = 0.9;
  double height_m = 2.1;  ///< upper edge over the wall's base
  double sill_m = 0.0;    ///< lower edge above the wall's base; if positive, a window
  std::optional<DoorLeaf> leaf{};
};

/// A wall along a polyline, with half its thickness on either side. Legs overlap at the corners to leave no gap.
struct Wall {
  std::vector<Point2> points_m;
  bool is_closed = false;
  double thickness_m = 0.1;
  double base_m = 0.0;
  double height_m = 2.5;
  std::vector<Door> doors;  ///< doors and windows

  [[nodiscard]] std::size_t leg_count() const {
    return points_m.size() < 2 ? 0 : points_m.size() - (is_closed ? 0 : 1);
  }
};

/// A solid part of the floor, which a robot drives on. Its height follows a profile along its x axis, is the same
/// across its width, and its underside is the floor under everything.
struct FloorPart {
  Point2 centre_m{0.0, 0.0};
  double yaw_rad = 0.0;
  double width_m = 1.0;           ///< along its y axis
  std::vector<Point2> profile_m;  ///< (x from the centre, height in the map), x ascending; straight in between
};

/// A ramp between the middles of its two ends, each (x, y, height).
FloorPart make_ramp(const Vec3& from_m, const Vec3& to_m, double width_m);
/// A raised level floor.
FloorPart make_plate(const Point2& centre_m, const Point2& size_m, double yaw_rad, double height_m);
/// A rounded sill along a line, raised by a cosine: `width_m` across the line, `height_m` over `base_m`.
FloorPart make_sill(const Point2& from_m, const Point2& to_m, double width_m, double height_m, double base_m);

/// The floor's height at a place: the highest part there, else `floor_m`. Linear in the parts.
double floor_height_m(const std::vector<FloorPart>& parts, double floor_m, const Point2& place_m);

/// All parts of a scene.
struct Scene {
  std::vector<Wall> walls;
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  std::vector<TriangleMesh> meshes;    ///< already in the map frame
  std::vector<FloorPart> floor_parts;  ///< need floor_m, and lie on or above it
  std::optional<double> floor_m;       ///< height of a floor under everything
  std::optional<double> ceiling_m;     ///< height of a ceiling over everything
};

/// Faults of a part, one sentence each; empty if it can be built.
std::vector<std::string> validate(const Box& box);
std::vector<std::string> validate(const Cylinder& cylinder);
std::vector<std::string> validate(const Wall& wall);
std::vector<std::string> validate(const FloorPart& part);

/// The boxes of a wall: pieces between the doors, lintels and door leaves.
std::vector<Box> boxes_of(const Wall& wall);

/// Placement of an imported mesh in the scene.
struct MeshPlacement {
  double scale = 1.0;  ///< metres per unit of the file
  bool y_is_up = false;
  Vec3 position_m{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;
};

/// Places a mesh from a file in a scene. It is scaled, turned about z and moved: p_map = R(yaw) * (scale * p_file) +
/// position. If y_is_up, (x, y, z) is mapped to (x, -z, y) first; otherwise z is up. The triangles keep their order;
/// each names three of the vertices.
TriangleMesh placed_mesh(std::span<const std::array<float, 3>> vertices,
                         std::span<const std::array<std::uint32_t, 3>> triangles, const MeshPlacement& placement);

/// Converts the whole scene to triangles. Throws ConfigError for a part with faults, a coordinate that is not finite or
/// too far out, a scene without triangles or with too many.
TriangleMesh triangulate(const Scene& scene);

}  // namespace gdtslam::sim
