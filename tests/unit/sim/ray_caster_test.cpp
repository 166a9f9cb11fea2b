// Ranges against geometry on paper, and what must not depend on Embree.
#include "gdtslam/sim/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::sim {
namespace {

// The inside of a room of 8 x 6 x 2.5 m about the origin.
TriangleMesh room_mesh() {
  Scene scene;
  scene.boxes.push_back({{0.0, 0.0}, {8.0, 6.0}, 0.0, 0.0, 2.5});
  return triangulate(scene);
}

Vec3 unit(double x, double y, double z) { return Vec3(x, y, z).normalized(); }

TEST(RayCaster, RoomGivesTheRangesOfGeometry) {
  const RayCaster caster(room_mesh());
  const Vec3 origin(1.0, -0.5, 1.0);
  for (int i = 0; i < 3600; ++i) {
    const double bearing = rad_from_deg(0.1 * i);
    const double c = std::cos(bearing);
    const double s = std::sin(bearing);
    const double to_x = (c > 0.0 ? 4.0 - 1.0 : 4.0 + 1.0) / std::fabs(c);
    const double to_y = (s > 0.0 ? 3.0 + 0.5 : 3.0 - 0.5) / std::fabs(s);
    const auto hit = caster.cast({origin, Vec3(c, s, 0.0)}, 100.0);
    ASSERT_TRUE(hit) << i;
    ASSERT_NEAR(hit->range_m, std::min(to_x, to_y), 1e-12) << i;
  }
}

TEST(RayCaster, MaximumRangeIsInclusive) {
  const RayCaster caster(room_mesh());
  const Ray ray{Vec3(0.0, 0.5, 1.0), Vec3(1.0, 0.0, 0.0)};
  EXPECT_TRUE(caster.cast(ray, 4.0));
  EXPECT_FALSE(caster.cast(ray, std::nextafter(4.0, 0.0)));
  EXPECT_FALSE(caster.cast({Vec3(4.5, 0.0, 1.0), Vec3(1.0, 0.0, 0.0)}, 100.0));
}

TEST(RayCaster, NothingEscapesThroughEdgesAndCorners) {
  const RayCaster caster(room_mesh());
  const Vec3 origin(0.3, -0.7, 1.1);
  Random random(5);
  for (const std::array<std::uint32_t, 3>& triangle : caster.mesh().triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& a = caster.mesh().vertices[triangle[k]];
      const Vec3& b = caster.mesh().vertices[triangle[(k + 1) % 3]];
      for (int i = 0; i <= 200; ++i) {
        const Vec3 target = a + (b - a) * (i == 200 ? 1.0 : random.uniform());
        const auto hit = caster.cast({origin, (target - origin).normalized()}, 100.0);
        ASSERT_TRUE(hit);
        ASSERT_NEAR(hit->range_m, (target - origin).norm(), 1e-9);
      }
    }
  }
}

TEST(RayCaster, LowestTriangleWinsATie) {
  TriangleMesh mesh;
  mesh.vertices = {{2.0, -1.0, -1.0}, {2.0, 1.0, -1.0}, {2.0, 0.0, 1.0}};
  mesh.triangles = {{1, 2, 0}, {0, 1, 2}, {2, 1, 0}};
  const RayCaster caster(mesh);
  EXPECT_EQ(caster.cast({Vec3::Zero(), unit(1.0, 0.0, 0.0)}, 5.0), (RayHit{2.0, 0}));
}

TEST(RayCaster, EveryInstructionSetOfEmbreeGivesTheSameBits) {
  Random random(11);
  Scene scene;
  for (int i = 0; i < 200; ++i) {
    scene.boxes.push_back({{random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0)},
                           {random.uniform(0.05, 1.0), random.uniform(0.05, 1.0)},
                           random.uniform(-3.0, 3.0),
                           0.0,
                           random.uniform(0.2, 2.0)});
  }
  scene.floor_m = 0.0;
  const TriangleMesh mesh = triangulate(scene);
  const RayCaster reference(mesh, {"sse2"});
  int compared = 0;
  for (const std::string isa : {"sse4.2", "avx", "avx2", "avx512", ""}) {
    std::optional<RayCaster> caster;
    try {
      caster.emplace(mesh, RayCasterOptions{isa});
    } catch (const UnavailableError&) {
      continue;  // not on this processor
    }
    ++compared;
    Random rays(3);
    int hits = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 origin(rays.uniform(-20.0, 20.0), rays.uniform(-20.0, 20.0), rays.uniform(0.1, 1.0));
      // Half of the rays are aimed at corners, where a choice is closest.
      const Vec3 target = i % 2 == 0
                              ? mesh.vertices[rays.below(mesh.vertices.size())]
                              : Vec3(rays.uniform(-20.0, 20.0), rays.uniform(-20.0, 20.0), rays.uniform(0.0, 2.0));
      const Ray ray{origin, (target - origin).normalized()};
      const auto hit = caster->cast(ray, 60.0);
      ASSERT_EQ(hit, reference.cast(ray, 60.0)) << isa << " ray " << i;
      hits += hit ? 1 : 0;
    }
    EXPECT_GT(hits, 10'000);
  }
  EXPECT_GE(compared, 2);
}

TEST(RayCaster, FarFromTheOriginNothingIsMissed) {
  // Single precision has steps of 6e-5 m here.
  Scene scene;
  scene.boxes.push_back({{990.0, -985.0}, {10.0, 10.0}, 0.0, 0.0, 3.0});
  const RayCaster caster(triangulate(scene));
  for (int i = 0; i < 3600; ++i) {
    const double bearing = rad_from_deg(0.1 * i);
    EXPECT_TRUE(
        caster.cast({Vec3(990.1234567, -985.7654321, 1.0), Vec3(std::cos(bearing), std::sin(bearing), 0.0)}, 50.0));
  }
  // A strip of 2 mm across, seen from 1.9 km away.
  scene.boxes = {{{900.0, 0.0}, {0.002, 0.002}, 0.0, 0.0, 3.0}};
  const RayCaster strip(triangulate(scene));
  const Vec3 origin(-990.0, 0.1, 1.0);
  for (int i = -9; i <= 9; ++i) {
    const Vec3 target(899.999, 1e-4 * i, 1.0);
    EXPECT_TRUE(strip.cast({origin, (target - origin).normalized()}, 2000.0)) << i;
  }
}

TEST(RayCaster, RefusesABrokenMesh) {
  TriangleMesh mesh;
  mesh.vertices = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(RayCaster{mesh}, ConfigError);
  mesh.vertices.emplace_back(std::nan(""), 0.0, 0.0);
  EXPECT_THROW(RayCaster{mesh}, ConfigError);
  EXPECT_THROW(RayCaster(room_mesh(), {"no-such-isa"}), UnavailableError);
}

}  // namespace
}  // namespace gdtslam::sim
