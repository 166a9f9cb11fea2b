#include "brute_polish.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "brute_force.hpp"
#include "brute_lattice.hpp"

namespace gdtslam::test {
namespace {

/// A float32 whose operations go through double and are rounded once more, which rounds them correctly: 53 bits are
/// more than 2 * 24 + 2. Nothing can be contracted so.
struct Single {
  float value = 0.0F;
  friend Single operator+(Single a, Single b) { return rounded(wide(a) + wide(b)); }
  friend Single operator-(Single a, Single b) { return rounded(wide(a) - wide(b)); }
  friend Single operator*(Single a, Single b) { return rounded(wide(a) * wide(b)); }

 private:
  static double wide(Single a) { return static_cast<double>(a.value); }
  static Single rounded(double exact) { return {static_cast<float>(exact)}; }
};

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
    const PoseCandidate pose{at[0].value, at[1].value, at[2].value,
                             brute_prior_cost(params_.prior, at[0].value, at[1].value, at[2].value)};
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

/// Field values under the points at a pose, nearest cell, one call of the cost for each.
std::vector<std::uint32_t> values_at(const ChoosePose::Params& params, const std::vector<std::uint16_t>& field,
                                     const std::vector<PointCells>& points, const PolishedPose& pose) {
  PoseCost::Params single = params.cost;
  single.interpolation = Interpolation::kNearest;
  single.form = CostForm::kDistance;
  single.cap = 65535;
  std::vector<std::uint32_t> values;
  for (const PointCells& point : points) {
    values.push_back(brute_pose_cost(single, field, {point}, {pose.x, pose.y, pose.theta, 0}));
  }
  return values;
}

template <class Condition>
std::uint32_t count_of(const std::vector<std::uint32_t>& values, Condition condition) {
  return static_cast<std::uint32_t>(std::count_if(values.begin(), values.end(), condition));
}

void count_evidence(const ChoosePose::Params& params, const std::vector<std::uint32_t>& values, MatchVerdict& verdict) {
  std::uint64_t sum = 0;
  for (const std::uint32_t value : values) {
    sum += std::min(value, params.cost.cap);
  }
  verdict.sum = static_cast<std::uint32_t>(sum);
  verdict.near = count_of(values, [&](std::uint64_t v) { return v <= params.gate; });
  verdict.beside =
      count_of(values, [&](std::uint64_t v) { return v > 2 * std::uint64_t{params.gate} && v < params.map_cap; });
  verdict.known = count_of(values, [&](std::uint64_t v) { return v < params.map_cap; });
}

bool far_from_mean(const ChoosePose::Params& params, const PolishedPose& pose) {
  const Single dx = Single{pose.x} - Single{params.prior.mean_x};
  const Single dy = Single{pose.y} - Single{params.prior.mean_y};
  const Single dt = Single{pose.theta} - Single{params.prior.mean_theta};
  return (dx * dx + dy * dy).value > params.far_sq_cells || dt.value > params.far_rad || -dt.value > params.far_rad;
}

}  // namespace

std::vector<PolishedPose> brute_starts(const PoseStarts::Params& params, const std::vector<PoseCandidate>& candidates,
                                       const std::vector<std::uint32_t>& picks, std::size_t count) {
  std::vector<PolishedPose> starts;
  for (std::size_t i = 0; i < count; ++i) {
    PolishedPose start;
    start.x = params.x;
    start.y = params.y;
    start.theta = params.theta;
    if (i > 0 && picks.at(2 * (i - 1) + 1) < params.candidate_count) {
      const PoseCandidate& candidate = candidates.at(picks[2 * (i - 1) + 1]);
      start.x = candidate.x;
      start.y = candidate.y;
      start.theta = candidate.theta;
    }
    starts.push_back(start);
  }
  return starts;
}

PolishedPose brute_descent(const PoseSimplex::Params& params, const std::vector<std::uint16_t>& field,
                           const std::vector<PointCells>& points, const PolishedPose& start, BruteMoves* moves) {
  BruteMoves unused;
  return Descent(params, field, points, moves == nullptr ? unused : *moves).from(start);
}

MatchVerdict brute_choice(const ChoosePose::Params& params, const std::vector<std::uint16_t>& field,
                          const std::vector<PointCells>& points, const std::vector<PolishedPose>& poses) {
  MatchVerdict local;
  const std::vector<std::uint32_t> local_values = values_at(params, field, points, poses.at(0));
  count_evidence(params, local_values, local);
  const bool suspect = std::uint64_t{local.beside} * 65536 > std::uint64_t{params.contradiction_q16} * local.known ||
                       std::uint64_t{local.near} * 65536 < std::uint64_t{params.overlap_q16} * points.size();
  std::vector<PointCells> voters;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (suspect || (local_values[i] < params.cost.cap && local_values[i] < params.map_cap)) {
      voters.push_back(points[i]);
    }
  }
  std::map<std::pair<std::uint64_t, std::uint32_t>, PolishedPose> ranked;
  std::uint64_t evaluations = 0;
  for (std::uint32_t i = 0; i < params.pose_count; ++i) {
    const PolishedPose& pose = poses.at(i);
    const std::uint32_t bias = brute_prior_cost(params.prior, pose.x, pose.y, pose.theta);
    std::uint64_t cost = brute_pose_cost(params.cost, field, voters, {pose.x, pose.y, pose.theta, bias});
    if (i == 0) {
      local.local_cost = static_cast<std::uint32_t>(cost);
    }
    if (params.leap_q8 != 0 && !far_from_mean(params, poses.at(0)) && far_from_mean(params, pose)) {
      cost = std::min<std::uint64_t>(cost * params.leap_q8 / 256, 0xFFFFFFFFU);
    }
    evaluations += pose.evaluations;
    ranked[{cost, i}] = pose;
  }
  const auto& [rank, chosen] = *ranked.begin();
  MatchVerdict verdict;
  count_evidence(params, values_at(params, field, points, chosen), verdict);
  verdict.x = chosen.x;
  verdict.y = chosen.y;
  verdict.theta = chosen.theta;
  verdict.cost = static_cast<std::uint32_t>(rank.first);
  verdict.chosen = rank.second;
  verdict.evaluations = static_cast<std::uint32_t>(evaluations % (1ULL << 32U));
  verdict.stop = chosen.stop;
  verdict.voters = static_cast<std::uint32_t>(voters.size());
  verdict.local_cost = local.local_cost;
  return verdict;
}

}  // namespace gdtslam::test
