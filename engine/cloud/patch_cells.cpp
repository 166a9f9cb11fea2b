#include "patch_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/core/quantile.hpp"
#include "engine/core/to_position.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kBits = 21;  // bits of a cell's number along an axis, one more than used: a step never wraps
constexpr double kMostAlong = 1 << 20;
constexpr std::uint32_t kNone = ~std::uint32_t{0};

std::uint64_t cube_key(const Point3& from_corner, double edge_m) {
  std::uint64_t key = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    key = key << kBits | static_cast<std::uint64_t>(std::floor(from_corner[axis] / edge_m) + 1.0);
  }
  return key;
}

// The neighbours that come later in the order of keys, as differences of keys.
std::array<std::uint64_t, 13> later_neighbours() {
  std::array<std::uint64_t, 13> steps{};
  std::size_t count = 0;
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      for (std::int64_t z = -1; z <= 1; ++z) {
        const std::int64_t step = x * (std::int64_t{1} << (2U * kBits)) + y * (std::int64_t{1} << kBits) + z;
        if (step > 0) steps[count++] = static_cast<std::uint64_t>(step);
      }
    }
  }
  return steps;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parents, std::uint32_t k) {
  while (parents[k] != k) {
    parents[k] = parents[parents[k]];
    k = parents[k];
  }
  return k;
}

}  // namespace

std::vector<std::uint32_t> usable_points(std::span<const CloudPoint> cloud) {
  constexpr double kOuter = 0.01;  // share of the points at each end of an axis that do not count for the extent
  constexpr double kMost = 10.0;
  std::vector<std::uint32_t> points;
  points.reserve(cloud.size());
  for (std::uint32_t k = 0; k < cloud.size(); ++k) {
    if (to_position(cloud[k]).allFinite()) points.push_back(k);
  }
  if (points.empty()) return points;
  Point3 low;
  Point3 high;
  std::vector<double> values(points.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < points.size(); ++k) values[k] = to_position(cloud[points[k]])[axis];
    low[axis] = value_at_share(values, kOuter);
    high[axis] = value_at_share(values, 1.0 - kOuter);
  }
  const double reach_m = kMost * std::max(1.0, (high - low).maxCoeff());
  std::erase_if(points, [&](std::uint32_t k) {
    const Point3 point = to_position(cloud[k]);
    return (low - point).maxCoeff() > reach_m || (point - high).maxCoeff() > reach_m;
  });
  return points;
}

PatchCells::PatchCells(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points, double edge_m)
    : edge_m_(edge_m) {
  Point3 low = Point3::Constant(0.0);
  Point3 high = Point3::Constant(0.0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point3 point = to_position(cloud[points[k]]);
    low = k == 0 ? point : Point3(low.cwiseMin(point));
    high = k == 0 ? point : Point3(high.cwiseMax(point));
  }
  edge_m_ = std::max(edge_m_, (high - low).maxCoeff() / (kMostAlong - 4.0));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // key, index in `points`
  order.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    order.emplace_back(cube_key(to_position(cloud[points[k]]) - low, edge_m_), k);
  }
  std::sort(order.begin(), order.end());
  cell_of_.resize(points.size());
  points_.reserve(points.size());
  for (const auto& [key, k] : order) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      begins_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
    cell_of_[k] = size() - 1;
    points_.push_back(points[k]);
  }
  begins_.push_back(static_cast<std::uint32_t>(points_.size()));
}

std::uint32_t PatchCells::find(std::uint64_t key) const {
  const auto at = std::lower_bound(keys_.begin(), keys_.end(), key);
  return at != keys_.end() && *at == key ? static_cast<std::uint32_t>(at - keys_.begin()) : kNone;
}

Cloud PatchCells::cell_means(std::span<const CloudPoint> cloud) const {
  Cloud means(size());
  for (std::uint32_t k = 0; k < size(); ++k) {
    Point3 sum = Point3::Zero();
    for (const std::uint32_t point : cell_points(k)) sum += to_position(cloud[point]);
    const Point3 mean = sum / static_cast<double>(cell_points(k).size());
    means[k].x_m = static_cast<float>(mean.x());
    means[k].y_m = static_cast<float>(mean.y());
    means[k].z_m = static_cast<float>(mean.z());
  }
  return means;
}

void PatchCells::link() {
  const std::array<std::uint64_t, 13> steps = later_neighbours();
  for (std::uint32_t k = 0; k < keys_.size(); ++k) {
    for (const std::uint64_t step : steps) {
      const std::uint32_t other = find(keys_[k] + step);
      if (other != kNone) links_.emplace_back(k, other);
    }
  }
}

std::vector<bool> PatchCells::grown(const std::vector<bool>& is_marked) const {
  std::vector<bool> result = is_marked;
  for (const auto& [k, other] : links_) {
    if (is_marked[k]) result[other] = true;
    if (is_marked[other]) result[k] = true;
  }
  return result;
}

std::vector<std::uint32_t> PatchCells::largest_group(const std::vector<bool>& is_marked) const {
  std::vector<std::uint32_t> parents(keys_.size());
  std::iota(parents.begin(), parents.end(), 0U);
  for (const auto& [k, other] : links_) {
    if (!is_marked[k] || !is_marked[other]) continue;
    const std::uint32_t a = find_root(parents, k);
    const std::uint32_t b = find_root(parents, other);
    parents[std::max(a, b)] = std::min(a, b);
  }
  std::vector<std::uint32_t> sizes(keys_.size(), 0);
  for (std::uint32_t k = 0; k < keys_.size(); ++k) sizes[find_root(parents, k)] += is_marked[k] ? 1U : 0U;
  const auto largest = static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<std::uint32_t> group;
  for (std::uint32_t k = 0; k < keys_.size(); ++k) {
    if (is_marked[k] && find_root(parents, k) == largest) group.push_back(k);
  }
  return group;
}

}  // namespace gdtslam
