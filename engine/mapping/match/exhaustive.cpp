#include "exhaustive.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::uint32_t samples_per_side(float half, float step) {
  return half <= 0.0F ? 0U : static_cast<std::uint32_t>(std::ceil(half / step));
}

// The samples of a window, theta outermost, then y, then x.
struct Lattice {
  std::uint32_t count_xy;
  std::uint32_t count_theta;
  std::vector<CellPose> poses;
  std::vector<std::uint32_t> costs;

  [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t t) const {
    return (std::size_t{t} * count_xy + y) * count_xy + x;
  }
  // True if no neighbour is better; among equals the lowest index counts.
  [[nodiscard]] bool is_local_minimum(std::uint32_t x, std::uint32_t y, std::uint32_t t) const;
};

bool Lattice::is_local_minimum(std::uint32_t x, std::uint32_t y, std::uint32_t t) const {
  const std::size_t self = index(x, y, t);
  const auto low = [](std::uint32_t v) { return v == 0 ? 0 : v - 1; };
  for (std::uint32_t k = low(t); k <= std::min(t + 1, count_theta - 1); ++k) {
    for (std::uint32_t j = low(y); j <= std::min(y + 1, count_xy - 1); ++j) {
      for (std::uint32_t i = low(x); i <= std::min(x + 1, count_xy - 1); ++i) {
        const std::size_t other = index(i, j, k);
        if (costs[other] < costs[self] || (costs[other] == costs[self] && other < self)) return false;
      }
    }
  }
  return true;
}

// If a device has no room for a window, the step fails like a failed device: the CPU has room.
void require_room(std::size_t samples, const DeviceInfo& device) {
  const std::size_t bytes = samples * sizeof(PoseCandidate);
  if (bytes <= device.max_buffer_bytes) return;
  throw DeviceError(device.name, "allocate",
                    "no buffer for a search window: its " + std::to_string(samples) + " poses are " +
                        std::to_string(bytes) + " bytes, the largest allowed is " +
                        std::to_string(device.max_buffer_bytes) +
                        "; raise search.step and search.step_angle or lower search.max_half_width");
}

Lattice sample(Objective& objective, const SearchWindow& window) {
  Lattice lattice{.count_xy = window.count_xy(), .count_theta = window.count_theta(), .poses = {}, .costs = {}};
  const auto offset = [](std::uint32_t i, std::uint32_t count, float step) {
    const std::uint32_t middle = count / 2;
    return (static_cast<float>(i) - static_cast<float>(middle)) * step;
  };
  const std::size_t samples = std::size_t{lattice.count_xy} * lattice.count_xy * lattice.count_theta;
  require_room(samples, objective.device());
  lattice.poses.reserve(samples);
  for (std::uint32_t t = 0; t < lattice.count_theta; ++t) {
    for (std::uint32_t y = 0; y < lattice.count_xy; ++y) {
      for (std::uint32_t x = 0; x < lattice.count_xy; ++x) {
        lattice.poses.push_back({window.centre.x + offset(x, lattice.count_xy, window.step_cells),
                                 window.centre.y + offset(y, lattice.count_xy, window.step_cells),
                                 window.centre.theta + offset(t, lattice.count_theta, window.step_rad)});
      }
    }
  }
  lattice.costs.resize(lattice.poses.size());
  objective.evaluate(lattice.poses, lattice.costs, Interpolation::kNearest);
  return lattice;
}

// The best local minima of the lattice, by (cost, index).
std::vector<std::size_t> best_minima(const Lattice& lattice, std::uint32_t count) {
  std::vector<std::size_t> minima;
  for (std::uint32_t t = 0; t < lattice.count_theta; ++t) {
    for (std::uint32_t y = 0; y < lattice.count_xy; ++y) {
      for (std::uint32_t x = 0; x < lattice.count_xy; ++x) {
        if (lattice.is_local_minimum(x, y, t)) minima.push_back(lattice.index(x, y, t));
      }
    }
  }
  const auto better = [&](std::size_t a, std::size_t b) {
    return lattice.costs[a] != lattice.costs[b] ? lattice.costs[a] < lattice.costs[b] : a < b;
  };
  const std::size_t kept = std::min<std::size_t>(count, minima.size());
  std::partial_sort(minima.begin(), minima.begin() + static_cast<std::ptrdiff_t>(kept), minima.end(), better);
  minima.resize(kept);
  return minima;
}

}  // namespace

std::uint32_t SearchWindow::count_xy() const { return 2 * samples_per_side(half_xy_cells, step_cells) + 1; }
std::uint32_t SearchWindow::count_theta() const { return 2 * samples_per_side(half_theta_rad, step_rad) + 1; }

bool SearchWindow::holds(const CellPose& pose) const {
  return std::fabs(pose.x - centre.x) <= half_xy_cells && std::fabs(pose.y - centre.y) <= half_xy_cells &&
         std::fabs(pose.theta - centre.theta) <= half_theta_rad;
}

bool SearchWindow::has_at_edge(const CellPose& pose) const {
  if (half_xy_cells <= 0.0F || half_theta_rad <= 0.0F) return false;
  constexpr float kSlack = 0.5F;  // steps
  return std::fabs(pose.x - centre.x) > half_xy_cells - kSlack * step_cells ||
         std::fabs(pose.y - centre.y) > half_xy_cells - kSlack * step_cells ||
         std::fabs(pose.theta - centre.theta) > half_theta_rad - kSlack * step_rad;
}

std::vector<CellPose> best_samples(Objective& objective, const SearchWindow& window, std::uint32_t starts) {
  const Lattice lattice = sample(objective, window);
  std::vector<CellPose> best;
  for (const std::size_t index : best_minima(lattice, starts)) best.push_back(lattice.poses[index]);
  return best;
}

}  // namespace gdtslam
