// A window of more poses than the largest buffer of the device holds, costed there layer by layer: all positions at one
// angle at a time. The costs come back, four bytes a pose, and the host keeps the best local minima. Every cost is the
// one that it would be in the whole window, so the minima do not depend on the slicing. Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernels/pose_cost.hpp"
#include "gdtslam/compute/kernels/pose_lattice.hpp"
#include "gdtslam/mapping/objective.hpp"
#include "lattice_picks.hpp"

namespace gdtslam {

/// What the kernels need. The buffers must live until finish().
struct WindowWork {
  PoseLattice::Params lattice;
  PoseCost::Params cost;
  std::uint32_t wanted = 1;  ///< local minima, at least 1
  const Buffer* map = nullptr;
  const Buffer* points = nullptr;
  Buffer* candidates = nullptr;  ///< made as large as one layer
  Buffer* costs = nullptr;
};

class WindowLayers {
 public:
  explicit WindowLayers(Backend& backend) : backend_(&backend) {}

  /// Sets the device to work on the first layers and returns.
  void start(const WindowWork& work);
  [[nodiscard]] bool is_under_way() const { return picks_.has_value(); }
  /// Poses of the best local minima, ascending by (cost, index); no more than wanted.
  std::vector<CellPose> finish();

 private:
  [[nodiscard]] std::uint32_t layer_samples() const { return work_.lattice.count_xy * work_.lattice.count_xy; }
  void launch_batch();
  void launch_layer(std::uint32_t t);
  [[nodiscard]] CellPose pose_of(std::uint32_t index) const;

  Backend* backend_;
  WindowWork work_;
  std::uint32_t batch_layers_ = 1;
  std::uint32_t launched_ = 0;
  std::deque<PendingDownload> under_way_;
  std::optional<LatticePicks> picks_;
};

}  // namespace gdtslam
