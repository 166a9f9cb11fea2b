// The equations of many pairs of scans at once: by the workers on the host, or in one dispatch on a device, with the
// same bits. If the device fails, the host repeats the pairs. Not thread-safe. Cost: as point_to_line.hpp; on a device
// one submission a call, and 16 bytes a point of all scans in its memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compute/batch_device.hpp"
#include "engine/core/worker_pool.hpp"
#include "engine/mapping/adjust/point_to_line.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// A scan laid on another.
struct LinePair {
  std::size_t fixed = 0;   ///< number among the fixed scans
  std::size_t moving = 0;  ///< number among the moving ones
  Pose2 found_at;          ///< T_fixed_moving at which the lines are found
  Pose2 at;                ///< T_fixed_moving of the equations
  bool is_wanted = true;   ///< else the equations stay as they are
  bool is_found = false;   ///< the lines were found at `found_at` before
  LineEquations equations;
  std::vector<std::int32_t> lines{};  ///< on the host, the lines found
};

class LinePairs {
 public:
  /// Pairs at once on a device, and on the host.
  static constexpr std::size_t kDevicePairs = 32768;
  static constexpr std::size_t kHostPairs = 1024;

  /// `fixed` and `workers` must outlive this.
  LinePairs(std::span<const LineScan> fixed, WorkerPool& workers, BatchDevice device);

  /// Most pairs of a call that are worth their memory.
  [[nodiscard]] std::size_t at_once() const { return device_.get() != nullptr ? kDevicePairs : kHostPairs; }
  /// Builds the equations. `moving` may be the fixed scans themselves.
  void build(std::span<const LineScan> moving, const LineGate& gate, std::span<LinePair> pairs);

 private:
  [[nodiscard]] bool fits(const Backend& backend, std::size_t moving_bytes) const;
  void build_on_host(std::span<const LineScan> moving, const LineGate& gate, std::span<LinePair> pairs);
  void build_on_device(Backend& backend, std::span<const LineScan> moving, const LineGate& gate,
                       std::span<LinePair> pairs);
  void upload_fixed(Backend& backend, std::size_t moving_bytes);
  void upload_moving(Backend& backend, std::span<const LineScan> moving);

  std::span<const LineScan> fixed_;
  std::size_t fixed_bytes_;  // values of all fixed scans
  WorkerPool* workers_;
  BatchDevice device_;
  std::vector<std::uint32_t> first_value_;  // first value of each fixed scan's block, and the end of the last
  std::vector<std::uint32_t> moving_first_;
  std::vector<float> moving_values_;
  Buffer values_;
  Buffer bins_;
  Buffer pairs_;
  Buffer sums_;
};

}  // namespace gdtslam
