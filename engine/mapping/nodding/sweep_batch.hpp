// Input and output of the kernel sweep_points: strips of beams, and the data that the host keeps to make points from
// the result.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/nodding.hpp"
#include "gdtslam/core/stream.hpp"
#include "sweep_assembler.hpp"

namespace gdtslam {

/// Beam directions of scans in the nodding frame: one row of unit vectors for each layout of bearings, kept while scans
/// use it. Not thread-safe.
class BeamDirections {
 public:
  explicit BeamDirections(const NoddingMount& mount) : mount_(mount) {}

  /// Returns the row of a scan's first beam, and adds the rows if they are new; empty if there is no room for them.
  std::optional<std::uint32_t> find_row(const LaserScan& scan);

  /// x, y, z, as the kernel takes them.
  [[nodiscard]] const std::vector<std::array<float, 3>>& rows() const { return rows_; }
  /// A scan with more beams than this has the table to itself.
  static constexpr std::size_t kMostRows = std::size_t{1} << 18U;

 private:
  struct Layout {
    double first_bearing_rad;
    double bearing_step_rad;
    std::size_t beams;
    std::uint32_t row;
  };
  void append(double bearing_rad);

  NoddingMount mount_;
  std::vector<Layout> layouts_;
  std::vector<std::array<float, 3>> rows_;
};

/// The scan of a strip, and the anchor that its coordinates are relative to.
struct StripOrigin {
  double scan_stamp_s = 0.0;
  BeamTiming timing;
  double anchor_x_m = 0.0;
  double anchor_y_m = 0.0;
  std::size_t first_beam = 0;  ///< index in its scan
  std::uint32_t scan = 0;
};

/// Input of one dispatch. Ranges are 0 without a valid return.
struct SweepBatch {
  std::vector<BeamRange> beams;
  std::vector<BeamStrip> strips;
  std::vector<StripOrigin> origins;
  std::shared_ptr<const BeamDirections> directions;
};

/// x, y, z, elevation of a beam, as the kernel writes them.
using SweptBeam = std::array<float, 4>;

/// Appends the points of a batch in the order of its beams. Beams without a range are left out.
void append_points(const SweepBatch& batch, const std::vector<SweptBeam>& swept, std::vector<CloudPoint>& points);

/// The kernel's memory on a backend. Every call throws DeviceError when the device fails.
class SweepDevice {
 public:
  SweepDevice(Backend& backend, const NoddingScanner& scanner, const AssemblyLimits& limits, std::size_t most_beams);
  /// Submits a batch to the device and returns at once.
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

/// Motion during a scan. At least one knot of either kind, in the order of time.
struct ScanMotion {
  std::span<const PhaseKnot> phases;
  std::span<const PoseKnot> poses;
  BeamTiming timing;
  std::size_t beams = 0;
  Pose2 T_base_level;
};

/// Beams [first, first + count) of a scan. The pose is that of the sensor's position relative to the fix.
struct ScanStrip {
  std::size_t first = 0;
  std::uint32_t count = 0;
  Phase phase = 0;
  std::uint32_t phase_step = 0;
  Pose2 T_fix_level;
  Pose2 step;  ///< step of x, y and theta, each separately
};

/// A step of the phase is a whole number of 2^-32 turns: after this many beams the sum is at most 2^-23 of a turn off
/// (0.015 mm at 20 m).
inline constexpr std::uint32_t kMostBeamsOfStrip = 1024;
/// Limit for the sagitta of the arc on which the sensor moves when the robot turns.
inline constexpr double kMostSagitta_m = 1.0e-5;

/// Cuts a scan into strips for the kernel sweep_points: runs of neighbouring beams during which the crank turns evenly
/// and the sensor moves evenly. The cuts depend on the scan alone.
std::vector<ScanStrip> make_strips(const ScanMotion& motion);

}  // namespace gdtslam
