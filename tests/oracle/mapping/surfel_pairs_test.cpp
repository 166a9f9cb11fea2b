// Pairs of surfels against a search through all of them.
#include "engine/mapping/strokes/surfel_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

/// Surfels about the origin, so that coordinates have both signs; normals along the axes with some noise.
std::vector<Surfel> draw_surfels(Random& random, std::uint32_t strokes, std::size_t of_a_stroke, double half_m) {
  std::vector<Surfel> surfels;
  for (std::uint32_t stroke = 0; stroke < strokes; ++stroke) {
    for (std::size_t k = 0; k < of_a_stroke; ++k) {
      Surfel surfel;
      for (double& coordinate : surfel.mean) coordinate = random.uniform(-half_m, half_m);
      for (double& part : surfel.normal) part = random.normal(0.0, 0.4);
      surfel.normal[static_cast<Eigen::Index>(random.below(3))] += random.below(2) == 0 ? 1.0 : -1.0;
      surfel.normal.normalize();
      surfel.stroke = stroke;
      surfels.push_back(surfel);
    }
  }
  return surfels;
}

/// Every `every`-th surfel of a stroke has its nearest partners of all.
std::vector<SurfelPair> brute_pairs(const std::vector<Surfel>& surfels, std::size_t of_a_stroke, std::size_t every,
                                    const SurfelPairRules& rules) {
  std::vector<SurfelPair> pairs;
  for (std::size_t a = 0; a < surfels.size(); ++a) {
    if (a % of_a_stroke % every != 0) continue;
    std::vector<std::pair<double, std::uint32_t>> partners;
    for (std::size_t b = 0; b < surfels.size(); ++b) {
      const double distance_m = (surfels[a].mean - surfels[b].mean).norm();
      const double cosine = surfels[a].normal.dot(surfels[b].normal);
      if (surfels[a].stroke != surfels[b].stroke && distance_m <= rules.within_m && cosine >= rules.alike) {
        partners.emplace_back(distance_m, static_cast<std::uint32_t>(b));
      }
    }
    std::sort(partners.begin(), partners.end());
    if (partners.size() > rules.most) partners.resize(rules.most);
    for (const auto& [distance_m, b] : partners) pairs.emplace_back(static_cast<std::uint32_t>(a), b);
  }
  return pairs;
}

TEST(SurfelPairs, AreThoseOfASearchThroughAll) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const std::vector<Surfel> surfels = draw_surfels(random, 8, 40, seed % 2 == 0 ? 1.0 : 0.3);
    const SurfelPairRules rules{.most = 1 + seed % 5};
    const std::vector<SurfelPair> expected = brute_pairs(surfels, 40, 1, rules);
    ASSERT_GT(expected.size(), 30U);
    EXPECT_EQ(find_surfel_pairs(surfels, rules), expected) << seed;
  }
}

TEST(SurfelPairs, OfAStrokeWithManySurfelsEveryThirdLooksForPartners) {
  Random random(1);
  const std::vector<Surfel> surfels = draw_surfels(random, 5, 50, 0.6);
  const SurfelPairRules rules{.most_of_a_stroke = 17};
  EXPECT_EQ(find_surfel_pairs(surfels, rules), brute_pairs(surfels, 50, 3, rules));
}

TEST(SurfelPairs, OfNoneOrOneThereAreNone) {
  EXPECT_TRUE(find_surfel_pairs({}, {}).empty());
  EXPECT_TRUE(find_surfel_pairs(std::vector<Surfel>(1), {}).empty());
}

}  // namespace
}  // namespace gdtslam
