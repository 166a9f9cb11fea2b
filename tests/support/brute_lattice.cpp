#include "brute_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace gdtslam::test {
namespace {

// One operation on floats in double, rounded once more to float: the sum and the product of two floats come out
// correctly rounded so, as 53 >= 2 * 24 + 2 bits.
float sum(float a, float b) { return static_cast<float>(static_cast<double>(a) + static_cast<double>(b)); }
float product(float a, float b) { return static_cast<float>(static_cast<double>(a) * static_cast<double>(b)); }

float coordinate(float centre, std::int64_t i, std::int64_t count, float step) {
  const std::int64_t middle = count / 2;
  const float steps = sum(static_cast<float>(i), -static_cast<float>(middle));
  return sum(centre, product(steps, step));
}

float lesser_of(float cost, float limit) {
  if (std::isnan(cost) || cost >= limit) {
    return limit;
  }
  return cost;
}

}  // namespace

std::uint32_t brute_prior_cost(const PriorParams& prior, float x, float y, float theta) {
  const float dx = sum(x, -prior.mean_x);
  const float dy = sum(y, -prior.mean_y);
  const float dt = sum(theta, -prior.mean_theta);
  const float shift = lesser_of(product(sum(product(dx, dx), product(dy, dy)), prior.weight_xy), prior.limit);
  const float turn = lesser_of(product(product(dt, dt), prior.weight_theta), prior.limit);
  return static_cast<std::uint32_t>(std::floor(static_cast<double>(sum(shift, turn))));
}

std::vector<PoseCandidate> brute_lattice(const PoseLattice::Params& params) {
  std::vector<PoseCandidate> samples;
  for (std::int64_t t = 0; t < params.count_theta; ++t) {
    for (std::int64_t y = 0; y < params.count_xy; ++y) {
      for (std::int64_t x = 0; x < params.count_xy; ++x) {
        PoseCandidate sample;
        sample.x = coordinate(params.centre_x, x, params.count_xy, params.step_cells);
        sample.y = coordinate(params.centre_y, y, params.count_xy, params.step_cells);
        sample.theta = coordinate(params.centre_theta, t, params.count_theta, params.step_rad);
        sample.bias = brute_prior_cost(params.prior, sample.x, sample.y, sample.theta);
        samples.push_back(sample);
      }
    }
  }
  return samples;
}

std::vector<std::uint32_t> brute_minima(const LatticeMinima::Params& params, const std::vector<std::uint32_t>& costs) {
  const std::int64_t n = params.count_xy;
  const std::int64_t turns = params.count_theta;
  std::vector<std::uint32_t> minima(costs.size(), kNoCost);
  for (std::int64_t i = 0; i < n * n * turns; ++i) {
    std::pair<std::uint32_t, std::int64_t> best{kNoCost, n * n * turns};
    for (std::int64_t neighbour = 0; neighbour < 27; ++neighbour) {
      const std::int64_t x = i % n + neighbour % 3 - 1;
      const std::int64_t y = i / n % n + neighbour / 3 % 3 - 1;
      const std::int64_t t = i / n / n + neighbour / 9 - 1;
      if (x >= 0 && y >= 0 && t >= 0 && x < n && y < n && t < turns) {
        const std::int64_t index = x + n * (y + n * t);
        best = std::min(best, {costs[static_cast<std::size_t>(index)], index});
      }
    }
    if (best.second == i) {
      minima[static_cast<std::size_t>(i)] = best.first;
    }
  }
  return minima;
}

std::vector<std::uint32_t> brute_smallest(const std::vector<std::uint32_t>& values, std::uint32_t wanted) {
  std::multimap<std::uint32_t, std::uint32_t> sorted;  // equal keys keep the order of their insertion
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    if (values[i] != kNoCost) {
      sorted.emplace(values[i], i);
    }
  }
  std::vector<std::uint32_t> picks;
  for (const auto& [value, index] : sorted) {
    if (picks.size() < 2 * std::size_t{wanted}) {
      picks.insert(picks.end(), {value, index});
    }
  }
  picks.resize(2 * std::size_t{wanted}, kNoCost);
  return picks;
}

}  // namespace gdtslam::test
