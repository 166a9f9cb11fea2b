#include "brute_polish.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "brute_force.hpp"
#include "single.hpp"

namespace gdtslam::test {
namespace {

using Coordinates = std::array<Single, 3>;  // x, y, theta

/// Vertices by cost; among equals the one that came first stays in front.
using Vertices = std::multimap<std::uint32_t, Coordinates>;

Coordinates on_line(const Coordinates& origin, const Coordinates& end, float factor) {
  Coordinates result;
  for (std::size_t k = 0; k < 3; ++k) {
    result[k] = origin[k] + Single{factor} * (end[k] - origin[k]);
  }
  return result;
}

/// The prior's cost of a pose, cut towards zero.
std::uint32_t prior_cost(const PriorParams& prior, const Coordinates& at) {
  const Single dx = at[0] - Single{prior.mean_x};
  const Single dy = at[1] - Single{prior.mean_y};
  const Single dt = at[2] - Single{prior.mean_theta};
  const auto limited = [&](Single cost) { return cost.value < prior.limit ? cost : Single{prior.limit}; };
  const Single shift = limited((dx * dx + dy * dy) * Single{prior.weight_xy});
  const Single turn = limited((dt * dt) * Single{prior.weight_theta});
  return static_cast<std::uint32_t>((shift + turn).value);
}

class Descent {
 public:
  Descent(const PoseSimplex::Params& params, const std::vector<std::uint16_t>& field,
          const std::vector<PointCells>& points, BruteMoves& moves)
      : params_(params), field_(field), points_(points), moves_(moves) {}

  PolishedPose from(const PolishedPose& start) {
    const Coordinates first{Single{start.x}, Single{start.y}, Single{start.theta}};
    add(first);
    for (std::size_t k = 0; k < 3; ++k) {
      Coordinates stepped = first;
      stepped[k] = stepped[k] + Single{k == 2 ? params_.step_rad : params_.step_cells};
      add(stepped);
    }
    while (!is_small() && calls_ < params_.max_evaluations) {
      move();
    }
    PolishedPose end = start;
    end.stop = is_small() ? 1 : 2;
    end.cost = vertices_.begin()->first;
    end.x = vertices_.begin()->second[0].value;
    end.y = vertices_.begin()->second[1].value;
    end.theta = vertices_.begin()->second[2].value;
    end.evaluations = static_cast<std::uint32_t>((std::uint64_t{start.evaluations} + calls_) % (1ULL << 32U));
    return end;
  }

 private:
  std::uint32_t cost(const Coordinates& at) {
    ++calls_;
    const PoseCandidate pose{at[0].value, at[1].value, at[2].value, prior_cost(params_.prior, at)};
    return brute_pose_cost(params_.cost, field_, points_, pose);
  }

  void add(const Coordinates& at) { vertices_.emplace(cost(at), at); }

  [[nodiscard]] bool is_small() const {
    std::array<float, 3> largest{};
    const Coordinates& best = vertices_.begin()->second;
    for (const auto& [unused, at] : vertices_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const float length = std::fabs((at[k] - best[k]).value);
        largest[k] = std::isnan(length) ? largest[k] : std::max(largest[k], length);
      }
    }
    return std::max(largest[0], largest[1]) < params_.stop_cells && largest[2] < params_.stop_rad;
  }

  void move() {
    const std::vector<std::pair<std::uint32_t, Coordinates>> v(vertices_.begin(), vertices_.end());
    const auto& [worst_cost, worst] = v[3];
    Coordinates centre;
    for (std::size_t k = 0; k < 3; ++k) {
      centre[k] = ((v[0].second[k] + v[1].second[k]) + v[2].second[k]) * Single{1.0F / 3.0F};
    }
    const Coordinates reflection = on_line(centre, worst, -1.0F);
    const std::uint32_t reflection_cost = cost(reflection);
    if (reflection_cost < v[0].first) {
      const Coordinates expansion = on_line(centre, worst, -2.0F);
      const std::uint32_t expansion_cost = cost(expansion);
      const bool better = expansion_cost < reflection_cost;
      ++(better ? moves_.expansions : moves_.overshoots);
      replace_worst(better ? expansion : reflection, better ? expansion_cost : reflection_cost);
    } else if (reflection_cost < v[2].first) {
      ++moves_.reflections;
      replace_worst(reflection, reflection_cost);
    } else {
      const bool outside = reflection_cost < worst_cost;
      const Coordinates contraction = on_line(centre, worst, outside ? -0.5F : 0.5F);
      const std::uint32_t contraction_cost = cost(contraction);
      if (contraction_cost < reflection_cost && contraction_cost < worst_cost) {
        ++(outside ? moves_.outside : moves_.inside);
        replace_worst(contraction, contraction_cost);
      } else {
        ++moves_.shrinks;
        vertices_.clear();
        vertices_.insert(v[0]);
        for (std::size_t i = 1; i < 4; ++i) {
          add(on_line(v[0].second, v[i].second, 0.5F));
        }
      }
    }
  }

  // A vertex that comes last in its order of four stays behind its equals: multimap inserts there.
  void replace_worst(const Coordinates& at, std::uint32_t its_cost) {
    vertices_.erase(std::prev(vertices_.end()));
    vertices_.emplace(its_cost, at);
  }

  const PoseSimplex::Params& params_;
  const std::vector<std::uint16_t>& field_;
  const std::vector<PointCells>& points_;
  BruteMoves& moves_;
  Vertices vertices_;
  std::uint64_t calls_ = 0;
};

}  // namespace

PolishedPose brute_descent(const PoseSimplex::Params& params, const std::vector<std::uint16_t>& field,
                           const std::vector<PointCells>& points, const PolishedPose& start, BruteMoves* moves) {
  BruteMoves unused;
  return Descent(params, field, points, moves == nullptr ? unused : *moves).from(start);
}

}  // namespace gdtslam::test
