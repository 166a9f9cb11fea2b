#include <algorithm>
#include <cmath>

#include "counted.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::optimize {
namespace {

struct Swarm {
  std::vector<Valued> now;
  std::vector<Valued> own_best;
  std::vector<Point> velocities;
  std::size_t leader = 0;  ///< whose own best is the best of all
};

// The start and particles evenly at random in the box, each with a velocity of up to half the box.
Swarm first_swarm(Counted& function, const ParticleSwarm& method, Random& random) {
  Swarm swarm;
  for (std::size_t i = 0; i < method.particles; ++i) {
    Point point(function.dimensions());
    Point velocity(function.dimensions());
    for (std::size_t k = 0; k < point.size(); ++k) {
      point[k] = random.uniform(function.box().least[k], function.box().most[k]);
      velocity[k] = random.uniform(-0.5, 0.5) * function.width(k);
    }
    swarm.now.push_back({i == 0 ? function.start() : function.clamped(point), 0.0});
    swarm.velocities.push_back(velocity);
  }
  function.evaluate(swarm.now);
  swarm.own_best = swarm.now;
  return swarm;
}

void choose_leader(Swarm& swarm) {
  const auto best = std::min_element(swarm.own_best.begin(), swarm.own_best.end(), is_better);
  swarm.leader = static_cast<std::size_t>(best - swarm.own_best.begin());
}

// Clerc and Kennedy's equations with constriction chi. A particle that would leave the box stops at its face.
void fly(const Counted& function, Swarm& swarm, const ParticleSwarm& method, double chi, Random& random) {
  const Point& leader = swarm.own_best[swarm.leader].point;
  for (std::size_t i = 0; i < swarm.now.size(); ++i) {
    Point& point = swarm.now[i].point;
    Point& velocity = swarm.velocities[i];
    const Point& own = swarm.own_best[i].point;
    for (std::size_t k = 0; k < point.size(); ++k) {
      const double to_own = method.phi_1 * random.uniform() * (own[k] - point[k]);
      const double to_leader = method.phi_2 * random.uniform() * (leader[k] - point[k]);
      velocity[k] = chi * (velocity[k] + to_own + to_leader);
      velocity[k] = std::clamp(velocity[k], -function.width(k), function.width(k));
      const double wanted = point[k] + velocity[k];
      point[k] = std::clamp(wanted, function.box().least[k], function.box().most[k]);
      if (point[k] != wanted) velocity[k] = 0.0;
    }
  }
}

}  // namespace

Minimum minimise(Function& function, const Box& box, std::span<const double> start, const ParticleSwarm& method,
                 const Limits& limits) {
  const double phi = method.phi_1 + method.phi_2;
  if (!(phi > 4.0) || method.particles < 2)
    throw ConfigError("minimise: a swarm needs two particles and phi_1 + phi_2 > 4");
  const double chi = 2.0 / (phi - 2.0 + std::sqrt(phi * phi - 4.0 * phi));
  Counted counted(function, box, start, limits);
  Random random(method.seed);
  Swarm swarm = first_swarm(counted, method, random);
  std::uint32_t small_generations = 0;
  while (!counted.must_stop() && small_generations < method.patience) {
    choose_leader(swarm);
    fly(counted, swarm, method, chi, random);
    counted.evaluate(swarm.now);
    for (std::size_t i = 0; i < swarm.now.size(); ++i) {
      if (is_better(swarm.now[i], swarm.own_best[i])) swarm.own_best[i] = swarm.now[i];
    }
    small_generations = counted.is_small(swarm.now, method.tolerance) ? small_generations + 1 : 0;
  }
  return counted.result();
}

}  // namespace gdtslam::optimize
