// The ray caster against a search through all triangles: with our own intersection the answers must be equal bit for
// bit (the tree loses nothing), with a textbook one in extended precision the ranges must agree.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "engine/sim/surface_distance.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/sim/ray_caster.hpp"

namespace gdtslam::sim {
namespace {

std::optional<RayHit> search_all(const TriangleMesh& mesh, const Ray& ray, double max_range_m) {
  const ShearedRay sheared(ray);
  std::optional<RayHit> best;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto range_m = sheared.range_to(mesh.corners(i));
    if (range_m && *range_m <= max_range_m && (!best || *range_m < best->range_m)) {
      best = RayHit{*range_m, i};
    }
  }
  return best;
}

using Real = long double;
using Real3 = std::array<Real, 3>;

Real3 minus(const Vec3& a, const Vec3& b) {
  return {Real(a.x()) - Real(b.x()), Real(a.y()) - Real(b.y()), Real(a.z()) - Real(b.z())};
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Real3& a, const Real3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Moeller and Trumbore's test in extended precision. `margin` moves the edges outward, or inward when negative.
std::optional<double> textbook_range(const Ray& ray, const std::array<Vec3, 3>& corners, Real margin) {
  const Real3 e1 = minus(corners[1], corners[0]);
  const Real3 e2 = minus(corners[2], corners[0]);
  const Real3 direction{ray.direction.x(), ray.direction.y(), ray.direction.z()};
  const Real3 p = cross(direction, e2);
  const Real determinant = dot(e1, p);
  if (determinant == 0.0L) {
    return std::nullopt;
  }
  const Real3 t = minus(ray.origin_m, corners[0]);
  const Real u = dot(t, p) / determinant;
  const Real3 q = cross(t, e1);
  const Real v = dot(direction, q) / determinant;
  const Real range = dot(e2, q) / determinant;
  if (u < -margin || v < -margin || u + v > 1.0L + margin || range <= 0.0L) {
    return std::nullopt;
  }
  return static_cast<double>(range);
}

double nearest_textbook(const TriangleMesh& mesh, const Ray& ray, Real margin) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (const auto range_m = textbook_range(ray, mesh.corners(i), margin)) {
      best = std::min(best, *range_m);
    }
  }
  return best;
}

TriangleMesh random_triangles(Random& random, int count, double extent_m, double size_m) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 at(random.uniform(-extent_m, extent_m), random.uniform(-extent_m, extent_m), random.uniform(-1.0, 1.0));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(at + size_m * Vec3(random.normal(), random.normal(), random.normal()));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Vec3 random_direction(Random& random) {
  return Vec3(random.normal(), random.normal(), 0.2 * random.normal()).normalized();
}

TEST(RayCasterOracle, EqualsASearchThroughAllTriangles) {
  Random random(21);
  int hits = 0;
  for (const auto& [count, extent_m, size_m] :
       {std::tuple(1, 1.0, 0.5), std::tuple(2, 1.0, 1.0), std::tuple(97, 5.0, 0.7), std::tuple(1500, 30.0, 0.8),
        std::tuple(300, 300.0, 20.0), std::tuple(400, 900.0, 2.0)}) {
    const TriangleMesh mesh = random_triangles(random, count, extent_m, size_m);
    const RayCaster caster(mesh);
    for (int i = 0; i < 1500; ++i) {
      const Vec3 origin(random.uniform(-extent_m, extent_m), random.uniform(-extent_m, extent_m), 0.0);
      const Vec3 corner = mesh.vertices[random.below(mesh.vertices.size())];
      const Ray ray{origin, i % 3 == 0 ? (corner - origin).normalized() : random_direction(random)};
      const auto expected = search_all(mesh, ray, 2.0 * extent_m);
      ASSERT_EQ(caster.cast(ray, 2.0 * extent_m), expected) << count << " triangles, ray " << i;
      hits += expected ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 2000);
}

TEST(RayCasterOracle, RangesAgreeWithTheTextbook) {
  Random random(22);
  const TriangleMesh mesh = random_triangles(random, 400, 10.0, 1.0);
  const RayCaster caster(mesh);
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const Ray ray{Vec3(random.uniform(-10.0, 10.0), random.uniform(-10.0, 10.0), 0.0), random_direction(random)};
    // Rays within 1e-9 of an edge may fall either way.
    const double loose = nearest_textbook(mesh, ray, 1e-9L);
    const double strict = nearest_textbook(mesh, ray, -1e-9L);
    if (loose != strict) {
      continue;
    }
    ++compared;
    const auto hit = caster.cast(ray, 1000.0);
    ASSERT_EQ(hit.has_value(), std::isfinite(strict)) << i;
    if (hit) {
      ASSERT_NEAR(hit->range_m, strict, 1e-10) << i;
    }
  }
  EXPECT_GT(compared, 3900);
}

// Distance from a place to a triangle's part in a band of heights, by sampling the triangle densely.
double sampled_distance(const Point2& place, const std::array<Vec3, 3>& corners, double low_m, double high_m) {
  constexpr int kSteps = 60;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps - i; ++k) {
      const double u = static_cast<double>(i) / kSteps;
      const double v = static_cast<double>(k) / kSteps;
      const Vec3 p = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
      if (p.z() >= low_m && p.z() <= high_m) {
        best = std::min(best, std::hypot(p.x() - place.x(), p.y() - place.y()));
      }
    }
  }
  return best;
}

TEST(ClearanceOracle, AgreesWithDenseSampling) {
  Random random(23);
  const TriangleMesh mesh = random_triangles(random, 40, 4.0, 0.5);
  std::vector<Point2> places;
  for (int i = 0; i < 150; ++i) {
    places.emplace_back(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
  }
  const ClearanceQuery query{-0.4, 0.5, 1.5};
  const std::vector<double> clearances = clearances_m(mesh, query, places);
  int near = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double expected = query.limit_m;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      expected = std::min(expected, sampled_distance(places[i], mesh.corners(t), query.low_m, query.high_m));
    }
    // The samples are at most some centimetres apart, and never nearer than the triangle itself.
    EXPECT_LE(clearances[i], expected + 1e-9) << i;
    EXPECT_GE(clearances[i], expected - 0.06) << i;
    near += expected < query.limit_m ? 1 : 0;
  }
  EXPECT_GT(near, 50);
}

}  // namespace
}  // namespace gdtslam::sim
