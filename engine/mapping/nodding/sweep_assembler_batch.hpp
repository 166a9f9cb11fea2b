// Strips of beams on their way through the kernel sweep_points, and what the host keeps to make points of the result.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/nodding.hpp"
#include "sweep_assembler.hpp"
#include "sweep_assembler_directions.hpp"

namespace gdtslam {

/// Whose beams a strip has, and the place that its coordinates are relative to.
struct StripOrigin {
  double scan_stamp_s = 0.0;
  BeamTiming timing;
  double anchor_x_m = 0.0;
  double anchor_y_m = 0.0;
  std::size_t first_beam = 0;  ///< in its scan
  std::uint32_t scan = 0;
};

/// What one dispatch gets. Ranges are 0 where there was no valid return.
struct SweepBatch {
  std::vector<BeamRange> beams;
  std::vector<BeamStrip> strips;
  std::vector<StripOrigin> origins;
  std::shared_ptr<const BeamDirections> directions;
};

/// x, y, z, elevation of a beam, as the kernel leaves them.
using SweptBeam = std::array<float, 4>;

/// The points of a batch, in the order of its beams; those without a range are left out.
void append_points(const SweepBatch& batch, const std::vector<SweptBeam>& swept, std::vector<CloudPoint>& points);

/// The kernel's memory on a backend. Every call throws DeviceError when the device fails.
class SweepDevice {
 public:
  SweepDevice(Backend& backend, const NoddingScanner& scanner, const AssemblyLimits& limits, std::size_t most_beams);
  /// Sets the device to work on a batch and returns.
  PendingDownload start(const SweepBatch& batch);
  /// Waits for a batch.
  std::vector<SweptBeam> finish(PendingDownload download);

 private:
  void upload_tables(const std::shared_ptr<const BeamDirections>& directions);

  Backend& backend_;
  SweepPoints::Params params_;
  std::vector<float> elevations_;
  Buffer beams_;
  Buffer strips_;
  Buffer tables_;  ///< elevations and directions
  Buffer points_;
  std::shared_ptr<const BeamDirections> uploaded_;
  std::size_t uploaded_rows_ = 0;
};

}  // namespace gdtslam
