// The best local minima of a window's costs, taken in layer by layer: what the kernels LatticeMinima and SmallestValues
// find where all costs are there at once, while no more than three layers of one angle are kept. Not thread-safe. Cost:
// one look at each sample, and at the neighbours of those that are good enough.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gdtslam {

class LatticePicks {
 public:
  LatticePicks(std::uint32_t count_xy, std::uint32_t count_theta, std::uint32_t wanted);

  /// Room for the costs of the next layer, y outer, x inner; add() takes them in.
  std::span<std::uint32_t> next_layer();
  void add();
  /// Once all layers are in: indices of the samples in the whole window, ascending by (cost, index).
  [[nodiscard]] std::vector<std::uint32_t> indices() const;

 private:
  struct Pick {
    std::uint32_t cost;
    std::uint32_t index;
  };

  [[nodiscard]] const std::vector<std::uint32_t>& layer(std::uint32_t t) const { return layers_[t % layers_.size()]; }
  void examine(std::uint32_t t);
  [[nodiscard]] bool is_local_minimum(std::uint32_t t, std::uint32_t place) const;
  void insert(const Pick& pick);
  [[nodiscard]] std::uint32_t cost_to_beat() const;

  std::uint32_t count_xy_;
  std::uint32_t count_theta_;
  std::size_t wanted_;
  std::uint32_t added_ = 0;
  std::array<std::vector<std::uint32_t>, 3> layers_;
  std::vector<Pick> picks_;
};

}  // namespace gdtslam
