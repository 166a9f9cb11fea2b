// What holds of every method on every function: the box, the counts, the limits, the bits.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "oracle/optimize/standard_functions.hpp"

namespace gdtslam::optimize {
namespace {

/// A bowl with its floor anywhere, also beyond the box, and pieces that have no value.
StandardFunction random_function(Random& random) {
  const std::size_t n = 1 + random.below(5);
  std::vector<double> floor(n);
  for (double& x : floor) x = random.uniform(-3.0, 3.0);
  const double hole = random.uniform();
  return {"bowl", n, -2.0, 2.0, 0.0, [floor, hole](const double* x) {
            double sum = 0.0;
            for (std::size_t k = 0; k < floor.size(); ++k) sum += (x[k] - floor[k]) * (x[k] - floor[k]);
            return x[0] > 1.5 && hole < 0.3 ? std::numeric_limits<double>::quiet_NaN() : sum;
          }};
}

template <class Method>
class Minimise : public testing::Test {};
using Methods = testing::Types<NelderMead, ParticleSwarm, ShuffledComplex, SimplexAnnealing>;
TYPED_TEST_SUITE(Minimise, Methods);

TYPED_TEST(Minimise, stays_in_the_box_counts_right_and_returns_the_best_that_it_saw) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    Random random(seed);
    const StandardFunction function = random_function(random);
    Watched watched(function);
    std::vector<double> start(function.dimensions);
    for (double& x : start) x = random.uniform(-4.0, 4.0);  // also beyond the box
    const Limits limits{.max_evaluations = 20 + random.below(2000)};
    const Minimum found = minimise(watched, function.box(), start, TypeParam{}, limits);
    RC_ASSERT(watched.outside == 0U);
    RC_ASSERT(found.evaluations == watched.evaluations);
    RC_ASSERT(found.value == watched.least);
    RC_ASSERT(std::isinf(found.value) || found.value == function.value(found.point.data()));
    RC_ASSERT((found.stop == Stop::kEvaluations) == (found.evaluations >= limits.max_evaluations));
    RC_ASSERT(found.evaluations < limits.max_evaluations + watched.largest_batch);
  }));
}

// A limit may be met in the middle of a move, which then does not go on.
TYPED_TEST(Minimise, looks_at_its_limit_before_each_batch) {
  for (const std::uint64_t seed :
       {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3}, std::uint64_t{3553039830847430}}) {
    for (std::uint64_t most = 1; most < 220; ++most) {
      Random random(seed);
      const StandardFunction function = random_function(random);
      Watched watched(function);
      const std::vector<double> start(function.dimensions, 0.5);
      const Minimum found = minimise(watched, function.box(), start, TypeParam{}, {.max_evaluations = most});
      EXPECT_LT(found.evaluations, most + watched.last_batch) << seed << ", " << most;
    }
  }
}

TYPED_TEST(Minimise, the_same_seed_gives_the_same_bits) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    Random random(seed);
    const StandardFunction function = random_function(random);
    Watched first(function);
    Watched second(function);
    const std::vector<double> start(function.dimensions, 0.5);
    const Minimum a = minimise(first, function.box(), start, TypeParam{}, {.max_evaluations = 1000});
    const Minimum b = minimise(second, function.box(), start, TypeParam{}, {.max_evaluations = 1000});
    RC_ASSERT(a.point == b.point);
    RC_ASSERT(a.evaluations == b.evaluations);
  }));
}

TYPED_TEST(Minimise, finds_the_floor_of_a_bowl_within_the_box) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    Random random(seed);
    const std::size_t n = 1 + random.below(3);
    std::vector<double> floor(n);
    for (double& x : floor) x = random.uniform(-1.5, 1.5);
    const StandardFunction function{"bowl", n, -2.0, 2.0, 0.0, [floor](const double* x) {
                                      double sum = 0.0;
                                      for (std::size_t k = 0; k < floor.size(); ++k) {
                                        sum += (x[k] - floor[k]) * (x[k] - floor[k]);
                                      }
                                      return sum;
                                    }};
    Watched watched(function);
    const std::vector<double> start(n, -1.9);
    const Minimum found = minimise(watched, function.box(), start, TypeParam{}, {});
    RC_ASSERT(found.stop == Stop::kConverged);
    for (std::size_t k = 0; k < n; ++k) RC_ASSERT(std::abs(found.point[k] - floor[k]) < 1e-2);
  }));
}

TYPED_TEST(Minimise, stops_at_the_target) {
  Watched watched(rosenbrock());
  const Minimum found = minimise(watched, rosenbrock().box(), std::vector{-3.0, 3.0}, TypeParam{}, {.target = 1.0});
  EXPECT_EQ(found.stop, Stop::kTarget);
  EXPECT_LE(found.value, 1.0);
}

TYPED_TEST(Minimise, refuses_a_box_that_does_not_fit) {
  Watched watched(rosenbrock());
  const std::vector<double> start{0.0, 0.0};
  EXPECT_THROW(minimise(watched, Box{{0.0}, {1.0}}, start, TypeParam{}, {}), ConfigError);
  EXPECT_THROW(minimise(watched, Box{{0.0, 1.0}, {1.0, 1.0}}, start, TypeParam{}, {}), ConfigError);
  EXPECT_THROW(minimise(watched, rosenbrock().box(), std::vector{0.0}, TypeParam{}, {}), ConfigError);
  EXPECT_EQ(watched.evaluations, 0U);
}

TEST(Batches, a_generation_and_a_step_of_all_complexes_are_valued_at_once) {
  Watched swarm(rosenbrock());
  const std::vector<double> start{0.0, 0.0};
  minimise(swarm, rosenbrock().box(), start, ParticleSwarm{.particles = 40}, {.max_evaluations = 4000});
  EXPECT_EQ(swarm.evaluations, 40 * swarm.batches);
  Watched complexes(rosenbrock());
  minimise(complexes, rosenbrock().box(), start, ShuffledComplex{.complexes = 8}, {.max_evaluations = 4000});
  EXPECT_GT(static_cast<double>(complexes.evaluations), 2.0 * static_cast<double>(complexes.batches));
}

}  // namespace
}  // namespace gdtslam::optimize
