// Scenes become closed surfaces of the right size. Volumes come from the divergence theorem over the triangles, so a
// missing, doubled or flipped triangle changes them.
#include "gdtslam/sim/scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

double enclosed_volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

double volume_of(const Scene& scene) { return enclosed_volume(triangulate(scene)); }

double volume_of(const std::vector<Box>& boxes) {
  Scene scene;
  scene.boxes = boxes;
  return volume_of(scene);
}

TEST(Scene, BoxEnclosesItsVolumeAndStandsWhereItShould) {
  Scene scene;
  scene.boxes.push_back({{3.0, -2.0}, {2.0, 0.5}, rad_from_deg(30.0), 0.25, 1.5});
  const TriangleMesh mesh = triangulate(scene);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_NEAR(enclosed_volume(mesh), 2.0 * 0.5 * 1.5, 1e-12);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) {
    mean += v / static_cast<double>(mesh.vertices.size());
  }
  EXPECT_NEAR((mean - Vec3(3.0, -2.0, 1.0)).norm(), 0.0, 1e-12);
  // The half diagonal of the footprint is at atan(0.25 / 1) = 14.04 deg from the box's x axis.
  double largest_x = -1e9;
  for (const Vec3& v : mesh.vertices) {
    largest_x = std::max(largest_x, v.x());
  }
  EXPECT_NEAR(largest_x, 3.0 + std::hypot(1.0, 0.25) * std::cos(rad_from_deg(30.0) - std::atan(0.25)), 1e-12);
}

TEST(Scene, WallWithWindowsKeepsWhatIsUnderTheirSills) {
  Wall wall;
  wall.points_m = {{0.0, 0.0}, {6.0, 0.0}};
  wall.thickness_m = 0.2;
  wall.base_m = 1.0;
  wall.height_m = 2.5;
  wall.doors.push_back({.leg = 0, .from_m = 4.0, .width_m = 1.0, .height_m = 2.0, .sill_m = 0.75});
  wall.doors.push_back({.leg = 0, .from_m = 0.5, .width_m = 0.5, .height_m = 3.0, .sill_m = 1.5});
  EXPECT_TRUE(validate(wall).empty());
  const std::vector<Box> boxes = boxes_of(wall);
  EXPECT_NEAR(volume_of(boxes), (6.0 * 2.5 - 1.0 * 1.25 - 0.5 * 1.0) * 0.2, 1e-12);
  for (const Box& box : boxes) {
    EXPECT_GE(box.base_m, 1.0);
    const double low = box.centre_m.x() - 0.5 * box.size_m.x();
    if (low > 3.99 && low < 4.5) {
      EXPECT_TRUE(box.base_m == 3.0 || box.base_m + box.height_m == 1.75) << box.base_m;
    }
  }
  wall.doors = {{.leg = 0, .from_m = 4.0, .width_m = 1.0, .height_m = 0.5, .sill_m = 0.75}};
  EXPECT_EQ(validate(wall).size(), 1U);
}

TEST(Scene, DoorLeafTurnsAboutItsHinge) {
  Wall wall;
  wall.points_m = {{0.0, 0.0}, {4.0, 0.0}};
  const auto leaf_centre = [&](bool is_far, double angle_deg) {
    wall.doors = {
        {.leg = 0, .from_m = 1.0, .width_m = 0.8, .height_m = 2.0, .leaf = DoorLeaf{rad_from_deg(angle_deg), is_far}}};
    for (const Box& box : boxes_of(wall)) {
      if (box.size_m.y() == 0.04) {
        return box.centre_m;
      }
    }
    return Point2(std::nan(""), 0.0);
  };
  EXPECT_NEAR((leaf_centre(false, 0.0) - Point2(1.4, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((leaf_centre(true, 0.0) - Point2(1.4, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((leaf_centre(false, 90.0) - Point2(1.0, 0.4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((leaf_centre(true, 90.0) - Point2(1.8, 0.4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((leaf_centre(true, -90.0) - Point2(1.8, -0.4)).norm(), 0.0, 1e-12);
}

TEST(Scene, ClosedWallHasNoGapAtItsCorners) {
  Wall wall;
  wall.points_m = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}, {0.0, 3.0}};
  wall.is_closed = true;
  wall.thickness_m = 0.2;
  wall.height_m = 1.0;
  // Legs reach half a thickness beyond each corner: their sum counts each corner square twice.
  EXPECT_EQ(wall.leg_count(), 4U);
  EXPECT_NEAR(volume_of(boxes_of(wall)), (2 * 4.2 + 2 * 3.2) * 0.2, 1e-12);
}

TEST(Scene, FloorAndCeilingCoverEverything) {
  Scene scene;
  scene.boxes.push_back({{10.0, 0.0}, {2.0, 2.0}, 0.0, 0.0, 1.0});
  scene.floor_m = 0.0;
  scene.ceiling_m = 2.5;
  const TriangleMesh mesh = triangulate(scene);
  ASSERT_EQ(mesh.triangles.size(), 16U);
  EXPECT_EQ(mesh.corners(12)[0], Vec3(8.0, -2.0, 0.0));
  EXPECT_EQ(mesh.corners(14)[2], Vec3(12.0, 2.0, 2.5));
}

}  // namespace
}  // namespace gdtslam::sim
