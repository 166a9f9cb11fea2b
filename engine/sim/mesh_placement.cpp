#include "mesh_placement.hpp"

#include "engine/core/elementary.hpp"

namespace gdtslam::sim {
namespace {

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
