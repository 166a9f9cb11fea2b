#include "gdtslam/sim/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

std::uint32_t add_vertex(TriangleMesh& mesh, double x, double y, double z) {
  mesh.vertices.emplace_back(x, y, z);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

// An upright prism over a convex counter-clockwise outline.
void add_prism(TriangleMesh& mesh, const std::vector<Point2>& outline, double base_m, double height_m) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {base_m, base_m + height_m}) {
    for (const Point2& p : outline) {
      add_vertex(mesh, p.x(), p.y(), z);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = first + i;
    const std::uint32_t b = first + (i + 1) % n;
    mesh.triangles.push_back({a, b, b + n});
    mesh.triangles.push_back({a, b + n, a + n});
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    mesh.triangles.push_back({first, first + i + 1, first + i});
    mesh.triangles.push_back({first + n, first + n + i, first + n + i + 1});
  }
}

void add_box(TriangleMesh& mesh, const Box& box) {
  const Pose2 T_map_box{box.centre_m.x(), box.centre_m.y(), box.yaw_rad};
  const double x = 0.5 * box.size_m.x();
  const double y = 0.5 * box.size_m.y();
  add_prism(
      mesh,
      {T_map_box * Point2(-x, -y), T_map_box * Point2(x, -y), T_map_box * Point2(x, y), T_map_box * Point2(-x, y)},
      box.base_m, box.height_m);
}

void add_cylinder(TriangleMesh& mesh, const Cylinder& cylinder) {
  std::vector<Point2> outline;
  for (int i = 0; i < cylinder.sides; ++i) {
    const SinCos<double> at = sin_cos(kTwoPi * i / cylinder.sides);
    outline.emplace_back(cylinder.centre_m.x() + cylinder.radius_m * at.cos,
                         cylinder.centre_m.y() + cylinder.radius_m * at.sin);
  }
  add_prism(mesh, outline, cylinder.base_m, cylinder.height_m);
}

void add_wall(TriangleMesh& mesh, const Wall& wall) {
  for (const Box& box : boxes_of(wall)) add_box(mesh, box);
}

void add_mesh(TriangleMesh& mesh, const TriangleMesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const std::array<std::uint32_t, 3>& t : part.triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

// A closed solid; a side of height zero has triangles without area, which no ray meets.
void add_floor_part(TriangleMesh& mesh, const FloorPart& part, double floor_m) {
  const Pose2 T_map_part{part.centre_m.x(), part.centre_m.y(), part.yaw_rad};
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Point2& knot : part.profile_m) {
    for (const double y : {-0.5 * part.width_m, 0.5 * part.width_m}) {
      const Point2 p = T_map_part * Point2(knot.x(), y);
      add_vertex(mesh, p.x(), p.y(), floor_m);
      add_vertex(mesh, p.x(), p.y(), knot.y());
    }
  }
  // Vertices of a knot: 0 right below, 1 right top, 2 left below, 3 left top.
  const auto add_quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  };
  const auto last = static_cast<std::uint32_t>(4 * (part.profile_m.size() - 1));
  add_quad(0, 1, 3, 2);
  for (std::uint32_t k = 0; k < last; k += 4) {
    add_quad(k + 1, k + 5, k + 7, k + 3);
    add_quad(k + 2, k + 6, k + 4, k + 0);
    add_quad(k + 0, k + 4, k + 5, k + 1);
    add_quad(k + 3, k + 7, k + 6, k + 2);
  }
  add_quad(last + 2, last + 3, last + 1, last + 0);
}

// A rectangle below or above all parts, a metre larger than these on each side.
void add_slab(TriangleMesh& mesh, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double z_m) {
  constexpr double kMargin_m = 1.0;
  const std::uint32_t a = add_vertex(mesh, low.x() - kMargin_m, low.y() - kMargin_m, z_m);
  add_vertex(mesh, high.x() + kMargin_m, low.y() - kMargin_m, z_m);
  add_vertex(mesh, high.x() + kMargin_m, high.y() + kMargin_m, z_m);
  add_vertex(mesh, low.x() - kMargin_m, high.y() + kMargin_m, z_m);
  mesh.triangles.push_back({a, a + 1, a + 2});
  mesh.triangles.push_back({a, a + 2, a + 3});
}

void add_slabs(TriangleMesh& mesh, const Scene& scene) {
  if (mesh.vertices.empty() || (!scene.floor_m && !scene.ceiling_m)) {
    return;
  }
  Eigen::Vector2d low = mesh.vertices.front().head<2>();
  Eigen::Vector2d high = low;
  for (const Vec3& v : mesh.vertices) {
    low = low.cwiseMin(v.head<2>());
    high = high.cwiseMax(v.head<2>());
  }
  for (const std::optional<double>& z_m : {scene.floor_m, scene.ceiling_m}) {
    if (z_m) {
      add_slab(mesh, low, high, *z_m);
    }
  }
}

// Meshes are checked with all vertices, see check_finished().
std::vector<std::string> validate(const TriangleMesh& /*mesh*/) { return {}; }

// Adds the parts in order; refuses invalid parts and too many triangles.
template <class Part, class Add>
void add_parts(TriangleMesh& mesh, const std::vector<Part>& parts, const char* kind, const Add& add) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (const std::vector<std::string> faults = validate(parts[i]); !faults.empty()) {
      throw ConfigError(std::string(kind) + " " + std::to_string(i + 1) + " of the scene: " + faults.front());
    }
    add(mesh, parts[i]);
    if (mesh.triangles.size() > kMaxTriangles) {
      throw ConfigError("the scene has more than " + std::to_string(kMaxTriangles) + " triangles: simplify its meshes");
    }
  }
}

void add_floor_parts(TriangleMesh& mesh, const Scene& scene) {
  if (scene.floor_parts.empty()) return;
  if (!scene.floor_m) {
    throw ConfigError("ramps, plates and sills lie on a floor, but the scene has none: add `floor: 0`");
  }
  add_parts(mesh, scene.floor_parts, "ramp, plate or sill", [&](TriangleMesh& to, const FloorPart& part) {
    for (const Point2& knot : part.profile_m) {
      if (knot.y() >= *scene.floor_m) continue;
      throw ConfigError("a ramp, plate or sill is at " + std::to_string(knot.y()) + " m, under the floor at " +
                        std::to_string(*scene.floor_m) + " m: raise it, or lower the floor");
    }
    add_floor_part(to, part, *scene.floor_m);
  });
}

void check_finished(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) {
    throw ConfigError("the scene is empty: add at least one wall, box, cylinder or mesh");
  }
  for (const Vec3& v : mesh.vertices) {
    // Written so that a coordinate that is not a number fails too.
    if (!v.allFinite() || !(v.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
      throw ConfigError(
          "a part of the scene reaches further than 1000 m from the origin: move the scene to the origin");
    }
  }
}

Vec3 placed(const std::array<float, 3>& vertex, const MeshPlacement& placement, const SinCos<double>& yaw) {
  const double x = placement.scale * static_cast<double>(vertex[0]);
  const double up_or_y = placement.scale * static_cast<double>(vertex[1]);
  const double z_or_out = placement.scale * static_cast<double>(vertex[2]);
  const double y = placement.y_is_up ? -z_or_out : up_or_y;
  const double z = placement.y_is_up ? up_or_y : z_or_out;
  return {yaw.cos * x - yaw.sin * y + placement.position_m.x(), yaw.sin * x + yaw.cos * y + placement.position_m.y(),
          z + placement.position_m.z()};
}

}  // namespace

TriangleMesh triangulate(const Scene& scene) {
  TriangleMesh mesh;
  add_parts(mesh, scene.walls, "wall", add_wall);
  add_parts(mesh, scene.boxes, "box", add_box);
  add_parts(mesh, scene.cylinders, "cylinder", add_cylinder);
  add_parts(mesh, scene.meshes, "mesh", add_mesh);
  add_floor_parts(mesh, scene);
  add_slabs(mesh, scene);
  check_finished(mesh);
  return mesh;
}

TriangleMesh placed_mesh(std::span<const std::array<float, 3>> vertices,
                         std::span<const std::array<std::uint32_t, 3>> triangles, const MeshPlacement& placement) {
  const SinCos<double> yaw = sin_cos(placement.yaw_rad);
  TriangleMesh mesh;
  mesh.vertices.reserve(vertices.size());
  for (const std::array<float, 3>& vertex : vertices) mesh.vertices.push_back(placed(vertex, placement, yaw));
  mesh.triangles.assign(triangles.begin(), triangles.end());
  return mesh;
}

}  // namespace gdtslam::sim
