// Bounds of many tiles of boxes at once on a device (kernel PoseBounds), for searches that begin with many boxes. The
// dilated fields of a level go to the device at their first use and stay there. Same sums as on the host. Thread-safe:
// one thread at a time uses the backend, which no other code may use meanwhile. Throws DeviceError if the device fails.
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
  /// With fewer samples to add up, the host finishes before a device has answered.
  static constexpr std::uint64_t kLeastLookUps = std::uint64_t{1} << 22U;

  /// `backend` and `fields` must outlive this.
  DeviceBounds(Backend& backend, const BoundFields& fields);

  /// True if that many tiles are worth a launch, and the device has room for them.
  [[nodiscard]] bool takes(const PoseBounds::Params& params, std::size_t level, std::size_t tiles) const;
  /// Sums of tiles by the fields of the map's level `level`.
  void sum(const PoseBounds::Params& params, std::size_t level, std::span<const BoundPoint> points,
           std::span<const PoseCandidate> tiles, std::span<std::uint32_t> sums);
  /// Number of launches so far.
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
