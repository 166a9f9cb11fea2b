// A mesh set into a scene: scaled, turned, moved, stood up. The triangle's corners are worked out by hand.
#include "gdtslam/sim/scene.hpp"

#include <gtest/gtest.h>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::sim {
namespace {

const std::vector<std::array<float, 3>> kVertices{{0, 0, 0}, {1, 0, 0}, {0, 2, 3}};
const std::vector<std::array<std::uint32_t, 3>> kTriangles{{2, 0, 1}, {0, 1, 2}};

TEST(MeshPlacement, ScalesThenTurnsThenMoves) {
  MeshPlacement placement;
  placement.scale = 0.01;
  placement.yaw_rad = rad_from_deg(90.0);
  placement.position_m = {5.0, 6.0, 0.5};
  const TriangleMesh mesh = placed_mesh(kVertices, kTriangles, placement);
  EXPECT_EQ(mesh.triangles, kTriangles);
  ASSERT_EQ(mesh.vertices.size(), 3U);
  EXPECT_NEAR((mesh.vertices[0] - Vec3(5.0, 6.0, 0.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((mesh.vertices[1] - Vec3(5.0, 6.01, 0.5)).norm(), 0.0, 1e-12);   // 1 along x turns to y
  EXPECT_NEAR((mesh.vertices[2] - Vec3(4.98, 6.0, 0.53)).norm(), 0.0, 1e-12);  // 2 along y turns to -x
}

TEST(MeshPlacement, StandsUpWhatHasItsYUp) {
  const TriangleMesh mesh = placed_mesh(kVertices, kTriangles, {.y_is_up = true});
  EXPECT_NEAR((mesh.vertices[2] - Vec3(0.0, -3.0, 2.0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace gdtslam::sim
