// Bounds of many tiles of boxes at once on a device (kernel PoseBounds), for searches that begin with many boxes. The
// dilated fields of a level go to the device when they are first asked for and stay there. Same sums as on the host.
// Thread-safe: one thread at a time has the backend, which nobody else may use meanwhile. Throws DeviceError where the
// device fails.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "field.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

class DeviceBounds {
 public:
  /// Limit for one search: some MiB of sums.
  static constexpr std::size_t kMostTiles = 16384;
  /// Below so many samples to add up, the host is done before a device has answered.
  static constexpr std::uint64_t kLeastLookUps = std::uint64_t{1} << 22U;

  /// Both must outlive this.
  DeviceBounds(Backend& backend, const BoundFields& fields);

  /// Whether that many tiles are worth a launch, and the device has room for what it takes.
  [[nodiscard]] bool takes(const PoseBounds::Params& params, std::size_t level, std::size_t tiles) const;
  /// The sums of tiles by the fields of level `level` of the map's.
  void sum(const PoseBounds::Params& params, std::size_t level, std::span<const BoundPoint> points,
           std::span<const PoseCandidate> tiles, std::span<std::uint32_t> sums);
  /// Launches so far.
  [[nodiscard]] std::uint64_t launches() const { return launches_; }

 private:
  Backend& backend_;
  const BoundFields& fields_;
  std::mutex mutex_;             // guards the members below
  std::vector<Buffer> samples_;  // samples of each level
  Buffer points_;
  Buffer tiles_;
  Buffer sums_;
  std::atomic<std::uint64_t> launches_ = 0;
};

}  // namespace gdtslam
