// Which places of a path still need the scans around them: where a robot goes the same way again and again all day, the
// first passes tell as much as all of them [Kurz2021]. So memory, and the part of the graph that others are tied to,
// grow with the area and not with the hours. Not thread-safe. Cost: linear in the places kept and in the loops, each
// time.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"

namespace gdtslam {

/// When there are enough passes of a place.
struct PruningRules {
  std::size_t most_passes = 8;    ///< places beside it that keep their scans
  double near_m = 2.0;            ///< half of what is between two places along a path
  double near_rad = 0.785;        ///< in the same direction: scans see little behind them
  std::size_t places_later = 16;  ///< after which it is decided: until then stretches around it are looked at
};

class PlacePruning {
 public:
  explicit PlacePruning(const PruningRules& rules) : rules_(rules) {}

  /// To be called once a place, in their order, when the last node of the graph was looked at. The place whose scans
  /// go: one that enough others lie beside, and that a loop ties to them. Where all looks otherwise than it did before
  /// no loop is found, and the scans stay.
  std::optional<std::size_t> next(const PoseGraph& graph);
  /// Whether enough others lie beside a place, of those that were decided about and keep their scans.
  [[nodiscard]] bool is_crowded(const PoseGraph& graph, std::size_t place) const {
    return kept_beside(graph, place) >= rules_.most_passes;
  }

 private:
  [[nodiscard]] std::size_t kept_beside(const PoseGraph& graph, std::size_t place) const;

  PruningRules rules_;
  std::vector<std::size_t> kept_;  // kept ones among the places that were decided about
};

}  // namespace gdtslam
