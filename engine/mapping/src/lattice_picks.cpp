#include "lattice_picks.hpp"

#include <algorithm>
#include <cassert>

#include "gdtslam/compute/kernels/pose_lattice.hpp"

namespace gdtslam {

LatticePicks::LatticePicks(std::uint32_t count_xy, std::uint32_t count_theta, std::uint32_t wanted)
    : count_xy_(count_xy), count_theta_(count_theta), wanted_(wanted) {
  for (std::vector<std::uint32_t>& costs : layers_) costs.resize(std::size_t{count_xy} * count_xy);
}

std::span<std::uint32_t> LatticePicks::next_layer() { return layers_[added_ % layers_.size()]; }

// A layer can be judged when the one behind it is there.
void LatticePicks::add() {
  assert(added_ < count_theta_);
  ++added_;
  if (added_ >= 2) examine(added_ - 2);
  if (added_ == count_theta_) examine(added_ - 1);
}

std::vector<std::uint32_t> LatticePicks::indices() const {
  assert(added_ == count_theta_);
  std::vector<std::uint32_t> found;
  for (const Pick& pick : picks_) found.push_back(pick.index);
  return found;
}

void LatticePicks::examine(std::uint32_t t) {
  const std::vector<std::uint32_t>& costs = layer(t);
  const auto first = static_cast<std::uint32_t>(t * costs.size());
  for (std::uint32_t place = 0; place < costs.size(); ++place) {
    if (costs[place] >= cost_to_beat() || !is_local_minimum(t, place)) continue;
    insert({costs[place], first + place});
  }
}

// True when no neighbour is better; among equals the lowest index counts.
bool LatticePicks::is_local_minimum(std::uint32_t t, std::uint32_t place) const {
  const std::uint32_t own = layer(t)[place];
  const std::uint32_t x = place % count_xy_;
  const std::uint32_t y = place / count_xy_;
  const auto low = [](std::uint32_t v) { return v == 0 ? 0 : v - 1; };
  for (std::uint32_t k = low(t); k <= std::min(t + 1, count_theta_ - 1); ++k) {
    const std::vector<std::uint32_t>& costs = layer(k);
    for (std::uint32_t j = low(y); j <= std::min(y + 1, count_xy_ - 1); ++j) {
      for (std::uint32_t i = low(x); i <= std::min(x + 1, count_xy_ - 1); ++i) {
        const std::uint32_t other = j * count_xy_ + i;
        const bool comes_first = k < t || (k == t && other < place);
        if (costs[other] < own || (comes_first && costs[other] == own)) return false;
      }
    }
  }
  return true;
}

// Samples come in the order of their indices, so among equals the new one stands last.
void LatticePicks::insert(const Pick& pick) {
  const auto at = std::upper_bound(picks_.begin(), picks_.end(), pick,
                                   [](const Pick& a, const Pick& b) { return a.cost < b.cost; });
  picks_.insert(at, pick);
  if (picks_.size() > wanted_) picks_.pop_back();
}

std::uint32_t LatticePicks::cost_to_beat() const { return picks_.size() < wanted_ ? kNoCost : picks_.back().cost; }

}  // namespace gdtslam
