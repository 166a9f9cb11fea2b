#include "surfel_pairs.hpp"

#include <algorithm>
#include <unordered_map>

#include "cell_key.hpp"

namespace gdtslam {
namespace {

/// Surfels by the cube that their means lie in. Of more than `most` in a cube every second, third... is kept: a robot
/// that stands for an hour sees each surface a thousand times.
class Buckets {
 public:
  Buckets(std::span<const Surfel> surfels, double edge_m, std::size_t most) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
    keyed.reserve(surfels.size());
    for (std::size_t k = 0; k < surfels.size(); ++k) {
      keyed.emplace_back(key_of(cell_around(surfels[k].mean, edge_m)), static_cast<std::uint32_t>(k));
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t begin = 0; begin < keyed.size();) {
      std::size_t end = begin;
      while (end < keyed.size() && keyed[end].first == keyed[begin].first) ++end;
      const std::size_t first = order_.size();
      const std::size_t every = (end - begin + most - 1) / most;
      for (std::size_t k = begin; k < end; k += every) order_.push_back(keyed[k].second);
      ranges_.emplace(keyed[begin].first, std::pair(first, order_.size()));
      begin = end;
    }
  }
  [[nodiscard]] std::span<const std::uint32_t> in(const Cell& cell) const {
    const auto found = ranges_.find(key_of(cell));
    if (found == ranges_.end()) return {};
    return std::span(order_).subspan(found->second.first, found->second.second - found->second.first);
  }

 private:
  std::vector<std::uint32_t> order_;
  std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> ranges_;
};

/// Squared distance and index of a candidate; in this order the nearest comes first.
using Partner = std::pair<double, std::uint32_t>;

void find_partners(std::span<const Surfel> surfels, const Surfel& surfel, const Buckets& buckets,
                   const SurfelPairRules& rules, std::vector<Partner>& partners) {
  partners.clear();
  const Cell middle = cell_around(surfel.mean, rules.within_m);
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t z = -1; z <= 1; ++z) {
        for (const std::uint32_t k : buckets.in({middle[0] + x, middle[1] + y, middle[2] + z})) {
          const Surfel& other = surfels[k];
          const double sq_distance = (other.mean - surfel.mean).squaredNorm();
          if (other.stroke == surfel.stroke || sq_distance > rules.within_m * rules.within_m) continue;
          if (other.normal.dot(surfel.normal) < rules.alike) continue;
          partners.emplace_back(sq_distance, k);
        }
      }
    }
  }
  std::sort(partners.begin(), partners.end());
}

}  // namespace

std::vector<SurfelPair> find_surfel_pairs(std::span<const Surfel> surfels, const SurfelPairRules& rules) {
  const Buckets buckets(surfels, rules.within_m, rules.most_of_a_cube);
  std::vector<SurfelPair> pairs;
  std::vector<Partner> partners;
  for (std::size_t begin = 0; begin < surfels.size();) {
    std::size_t end = begin;
    while (end < surfels.size() && surfels[end].stroke == surfels[begin].stroke) ++end;
    const std::size_t every = (end - begin + rules.most_of_a_stroke - 1) / rules.most_of_a_stroke;
    for (std::size_t k = begin; k < end; k += every) {
      find_partners(surfels, surfels[k], buckets, rules, partners);
      const std::size_t count = std::min(partners.size(), rules.most);
      for (std::size_t n = 0; n < count; ++n) pairs.emplace_back(static_cast<std::uint32_t>(k), partners[n].second);
    }
    begin = end;
  }
  return pairs;
}

}  // namespace gdtslam
