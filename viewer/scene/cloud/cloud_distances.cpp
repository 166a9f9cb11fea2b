// Distances from cloud to cloud by a k-d tree: the reference in the order of the tree, no links, the middle of each
// stretch being the node that divides it [Bentley1975].
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {
namespace {

using Place = std::array<float, 3>;

constexpr std::size_t kLeaf = 12;  // places that are compared one by one

class PlaceTree {
 public:
  explicit PlaceTree(std::vector<Place> places) : places_(std::move(places)), axes_(places_.size()) {
    divide(0, places_.size());
  }
  /// The least squared distance below `bound`, else `bound`.
  [[nodiscard]] float nearest_squared(const Place& query, float bound) const {
    float best = bound;
    search(query, 0, places_.size(), best);
    return best;
  }

 private:
  // Across the longest side of the places' box, so that cells stay compact.
  [[nodiscard]] std::uint8_t longest_axis(std::size_t begin, std::size_t end) const {
    Place low = places_[begin];
    Place high = low;
    for (std::size_t k = begin; k < end; ++k) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], places_[k][a]);
        high[a] = std::max(high[a], places_[k][a]);
      }
    }
    std::uint8_t axis = 0;
    for (std::uint8_t a = 1; a < 3; ++a) {
      if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    }
    return axis;
  }

  void divide(std::size_t begin, std::size_t end) {
    while (end - begin > kLeaf) {
      const std::size_t middle = begin + (end - begin) / 2;
      const std::uint8_t axis = longest_axis(begin, end);
      const auto at = [this](std::size_t k) { return places_.begin() + static_cast<std::ptrdiff_t>(k); };
      std::nth_element(at(begin), at(middle), at(end),
                       [axis](const Place& a, const Place& b) { return a[axis] < b[axis]; });
      axes_[middle] = axis;
      divide(begin, middle);
      begin = middle + 1;
    }
  }

  void compare(const Place& query, const Place& place, float& best) const {
    const float dx = query[0] - place[0];
    const float dy = query[1] - place[1];
    const float dz = query[2] - place[2];
    best = std::min(best, dx * dx + dy * dy + dz * dz);
  }

  void search(const Place& query, std::size_t begin, std::size_t end, float& best) const {
    while (end - begin > kLeaf) {
      const std::size_t middle = begin + (end - begin) / 2;
      const std::uint8_t axis = axes_[middle];
      const float beyond = query[axis] - places_[middle][axis];
      compare(query, places_[middle], best);
      const bool is_low = beyond < 0.0F;
      search(query, is_low ? begin : middle + 1, is_low ? middle : end, best);
      if (beyond * beyond >= best) return;
      begin = is_low ? middle + 1 : begin;
      end = is_low ? end : middle;
    }
    for (std::size_t k = begin; k < end; ++k) compare(query, places_[k], best);
  }

  std::vector<Place> places_;
  std::vector<std::uint8_t> axes_;  // of the nodes, at their places
};

bool is_finite(const CloudPoint& point) {
  return std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m);
}

}  // namespace

std::vector<float> distances_to(std::span<const CloudPoint> cloud, std::span<const CloudPoint> reference,
                                double most_m) {
  std::vector<Place> places;
  places.reserve(reference.size());
  for (const CloudPoint& point : reference) {
    if (is_finite(point)) places.push_back({point.x_m, point.y_m, point.z_m});
  }
  const PlaceTree tree(std::move(places));
  const auto most = static_cast<float>(most_m);
  std::vector<float> distances(cloud.size(), most);
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const CloudPoint& point = cloud[k];
    if (!is_finite(point)) continue;
    const float squared = tree.nearest_squared({point.x_m, point.y_m, point.z_m}, most * most);
    if (squared < most * most) distances[k] = std::sqrt(squared);
  }
  return distances;
}

}  // namespace gdtslam
