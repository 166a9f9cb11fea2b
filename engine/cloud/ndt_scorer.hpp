// Scores of many poses of a cloud in a map of normal distributions at once, by the kernel ndt_cost: on the CPU or on a
// device, with the same result. A point counts in the cube that it lies in. Frame: the map's, metres. Cost: some
// nanoseconds a point and pose on a core; 4 bytes for each cube of the box around the map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/ndt_map.hpp"
#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

class NdtScorer {
 public:
  /// The backend must outlive this. Throws InputError if the box around the cubes has more than 2^26 of them,
  /// DeviceError.
  NdtScorer(const NdtMap& map, double noise_m, Backend& backend);

  /// A score for each pose, higher is better; at most 1000 for each point. At most 2^20 points and poses. Throws
  /// DeviceError.
  [[nodiscard]] std::vector<std::uint32_t> scores(std::span<const Point3> points, std::span<const Pose3> poses);

 private:
  Backend* backend_;
  NdtCost::Params params_;
  Buffer map_;
};

}  // namespace gdtslam
