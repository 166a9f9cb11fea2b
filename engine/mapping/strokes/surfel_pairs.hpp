// Pairs of surfels of different strokes that may be the same surface. Cost: O(surfels), some microseconds each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "surfels.hpp"

namespace gdtslam {

/// Indices of two surfels.
using SurfelPair = std::pair<std::uint32_t, std::uint32_t>;

struct SurfelPairRules {
  double within_m = 0.4;  ///< distance of the means
  double alike = 0.8;     ///< least cosine between the normals, so that the sides of a thin wall are no pair
  std::size_t most = 4;   ///< partners of one surfel: the nearest of other strokes
  std::size_t most_of_a_stroke = 200;  ///< surfels that look for partners; of more, every second, third...
  std::size_t most_of_a_cube = 100;    ///< likewise for partners in a cube of within_m
};

/// `surfels` as they lie now, in the order of their strokes. Pairs are in the order of the first.
std::vector<SurfelPair> find_surfel_pairs(std::span<const Surfel> surfels, const SurfelPairRules& rules);

}  // namespace gdtslam
