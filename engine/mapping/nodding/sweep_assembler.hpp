// Turns scans with poses into points in space: cuts each scan into strips, runs the kernel sweep_points on their beams
// and passes the points on. Frame: map. Results depend neither on the batches of scans nor on the backend. One
// assembler belongs to one thread. Memory: three batches and a scan.
//
// A scan without knots of the phase gives no points, nor do beams without a return: a range must be at least min_range
// and below both max_range and the scanner's own limit, as in the 2D part. Points come in the order of the scans and of
// their beams. Coordinates are computed in float32 within whole metres next to the robot, to which the host adds in
// double, so a point is as exact far from the map's origin as near it, but for the rounding to CloudPoint's float.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/nodding.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {

/// The robot's pose at a knot's time, relative to T_map_fix.
struct PoseKnot {
  double offset_s = 0.0;
  Pose2 T_fix_base;
};

struct AssemblyLimits {
  double min_range_m = ScanConfig{}.min_range_m;
  double max_range_m = ScanConfig{}.max_range_m;
  SweepForm form = SweepForm::kWorking;
  std::uint32_t batch_beams = 65536;  ///< beams of one upload, dispatch and download; at least 1024
};

class SweepAssembler {
 public:
  SweepAssembler(const NoddingScanner& scanner, const AssemblyLimits& limits, Backend& backend, CloudSink& sink);
  ~SweepAssembler();
  /// Queues a scan; `poses` (at least one) are in the order of time and cover the scan, linear in between. A full batch
  /// is sent out. Throws DeviceError; the queue is kept, including this scan, so that use_backend() can continue.
  void add(const NoddingScan& scan, std::uint32_t index, const Pose2& T_map_fix, std::span<const PoseKnot> poses);
  /// Delivers all queued scans. Scans still queued at the end of the assembler's life are lost. Throws DeviceError.
  void flush();
  /// Continues with another backend, including the queued scans.
  void use_backend(Backend& backend);
  /// Number of points passed to the sink so far.
  [[nodiscard]] std::uint64_t points() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
