// Distances to the nearest surface: the tree loses no triangle (equal to a search through all, bit for bit, for every
// instruction set), and the distance to one triangle is that of a convex minimisation in extended precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "engine/sim/surface_distance.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::sim {
namespace {

NearestSurface search_all(const TriangleMesh& mesh, const Vec3& point) {
  double sq_best = std::numeric_limits<double>::infinity();
  NearestSurface best;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const double sq_distance = sq_distance_to_triangle(point, mesh.corners(i));
    if (sq_distance < sq_best) {
      sq_best = sq_distance;
      best = {std::sqrt(sq_distance), i};
    }
  }
  return best;
}

// Along a line of the triangle, the best place: a parabola's vertex, clamped.
long double sq_distance_to_line_of(const Vec3& point, const Vec3& from, const Vec3& to) {
  long double sq_length = 0.0L;
  long double along = 0.0L;
  for (int k = 0; k < 3; ++k) {
    const long double d = static_cast<long double>(to[k]) - static_cast<long double>(from[k]);
    sq_length += d * d;
    along += d * (static_cast<long double>(point[k]) - static_cast<long double>(from[k]));
  }
  const long double share = sq_length > 0.0L ? std::clamp(along / sq_length, 0.0L, 1.0L) : 0.0L;
  long double sum = 0.0L;
  for (int k = 0; k < 3; ++k) {
    const long double at = static_cast<long double>(from[k]) +
                           share * (static_cast<long double>(to[k]) - static_cast<long double>(from[k]));
    sum += (static_cast<long double>(point[k]) - at) * (static_cast<long double>(point[k]) - at);
  }
  return sum;
}

// The triangle is swept by lines from the first corner to a place on the opposite edge; the squared distance to such a
// line is a convex function of that place, which a ternary search minimises. No normal, no cases.
double textbook_distance(const Vec3& point, const std::array<Vec3, 3>& corners) {
  const auto at = [&](long double share) {
    const Vec3 place = corners[1] + static_cast<double>(share) * (corners[2] - corners[1]);
    return sq_distance_to_line_of(point, corners[0], place);
  };
  long double low = 0.0L;
  long double high = 1.0L;
  for (int i = 0; i < 120; ++i) {
    const long double a = low + (high - low) / 3.0L;
    const long double b = high - (high - low) / 3.0L;
    if (at(a) <= at(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return static_cast<double>(std::sqrt(std::min({at(low), at(high), at(0.0L), at(1.0L)})));
}

Vec3 random_vector(Random& random, double size) {
  return size * Vec3(random.normal(), random.normal(), random.normal());
}

TriangleMesh scattered_triangles(Random& random, int count, double extent_m, double size_m) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 at(random.uniform(-extent_m, extent_m), random.uniform(-extent_m, extent_m), random.uniform(-1.0, 3.0));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + random_vector(random, size_m));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(SurfaceDistanceOracle, ATrianglesDistanceIsTheMinimumOverItsPlaces) {
  Random random(31);
  for (int i = 0; i < 4000; ++i) {
    std::array<Vec3, 3> corners{random_vector(random, 1.0), random_vector(random, 1.0), random_vector(random, 1.0)};
    if (i % 5 == 1) corners[2] = corners[1] + 1e-4 * random_vector(random, 1.0);                      // a sliver
    if (i % 5 == 2) corners[2] = corners[0] + random.uniform(-1.0, 2.0) * (corners[1] - corners[0]);  // no area
    if (i % 5 == 3) corners[1] = corners[0];
    const Vec3 point = i % 7 == 0 ? Vec3((corners[0] + corners[1] + corners[2]) / 3.0) : random_vector(random, 1.5);
    ASSERT_NEAR(std::sqrt(sq_distance_to_triangle(point, corners)), textbook_distance(point, corners), 1e-8) << i;
  }
}

TEST(SurfaceDistanceOracle, KnownPlacesAroundATriangle) {
  const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 3, 0)};
  EXPECT_EQ(sq_distance_to_triangle({1, 1, 2}, corners), 4.0);            // above the inside
  EXPECT_EQ(sq_distance_to_triangle({1, 1, -2}, corners), 4.0);           // below
  EXPECT_EQ(sq_distance_to_triangle({2, -3, 4}, corners), 25.0);          // an edge
  EXPECT_EQ(sq_distance_to_triangle({-2, -2, 1}, corners), 9.0);          // a corner
  EXPECT_EQ(sq_distance_to_triangle({7, -4, 0}, corners), 25.0);          // another
  EXPECT_NEAR(sq_distance_to_triangle({4, 3, 0}, corners), 5.76, 1e-15);  // the long edge, 2.4 away
  EXPECT_EQ(sq_distance_to_triangle({1, 1, 0}, corners), 0.0);
}

TEST(SurfaceDistanceOracle, EqualsASearchThroughAllTrianglesOnEveryInstructionSet) {
  Random random(32);
  for (const auto& [count, extent_m, size_m] :
       {std::tuple(1, 1.0, 0.5), std::tuple(2, 1.0, 1.0), std::tuple(97, 5.0, 0.7), std::tuple(1500, 30.0, 0.8),
        std::tuple(300, 300.0, 20.0), std::tuple(400, 900.0, 2.0)}) {
    TriangleMesh mesh = scattered_triangles(random, count, extent_m, size_m);
    mesh.triangles.push_back(mesh.triangles.front());  // a tie everywhere
    std::vector<SurfaceDistance> surfaces;
    surfaces.emplace_back(mesh);
    for (const char* isa : {"sse2", "sse4.2", "avx", "avx2", "avx512"}) {
      try {
        surfaces.emplace_back(mesh, RayCasterOptions{isa});
      } catch (const UnavailableError&) {
        continue;  // the processor lacks it
      }
    }
    ASSERT_GE(surfaces.size(), 2U);
    for (int i = 0; i < 700; ++i) {
      const Vec3 corner = mesh.vertices[random.below(mesh.vertices.size())];
      const double away_m = i % 4 == 0 ? 0.0 : i % 4 == 1 ? 1e-3 : i % 4 == 2 ? size_m : 2.0 * extent_m;
      const Vec3 point = corner + random_vector(random, away_m);
      const NearestSurface expected = search_all(mesh, point);
      for (const SurfaceDistance& each : surfaces) {
        ASSERT_EQ(each.nearest(point), expected) << count << " triangles, point " << i;
      }
    }
  }
}

TEST(SurfaceDistanceOracle, FarPointsAndManyThreads) {
  Random random(33);
  const TriangleMesh mesh = scattered_triangles(random, 200, 20.0, 1.0);
  const SurfaceDistance surfaces(mesh);
  for (const double far_m : {999.0, 1001.0, 1e6, 1e30}) {
    for (const Vec3& point : {Vec3(far_m, 0.0, 0.0), Vec3(-far_m, far_m, 1.0), Vec3(0.0, 3.0, far_m)}) {
      EXPECT_EQ(surfaces.nearest(point), search_all(mesh, point)) << far_m;
    }
  }
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i) points.push_back(random_vector(random, 15.0));
  std::vector<std::vector<NearestSurface>> answers(4);
  {
    std::vector<std::jthread> threads;
    for (auto& mine : answers) {
      threads.emplace_back([&surfaces, &points, &mine] {
        for (const Vec3& point : points) mine.push_back(surfaces.nearest(point));
      });
    }
  }
  for (std::size_t i = 0; i < points.size(); i += 97) EXPECT_EQ(answers[0][i], search_all(mesh, points[i]));
  for (const auto& mine : answers) EXPECT_EQ(mine, answers[0]);
}

TEST(SurfaceDistanceOracle, RefusesWhatHasNoSurface) {
  EXPECT_THROW(SurfaceDistance(TriangleMesh{}), ConfigError);
  EXPECT_THROW(SurfaceDistance(TriangleMesh{{Vec3(0, 0, 0)}, {{0, 0, 1}}}), ConfigError);
}

}  // namespace
}  // namespace gdtslam::sim
