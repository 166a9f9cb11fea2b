// The cost of candidate poses of one scan in the map, paper equation (4), plus a prior around a predicted pose: every
// matcher minimises it. Poses are in cells and radians relative to the anchor cell. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// A pose in cells and radians relative to the anchor cell's lower left corner.
struct CellPose {
  float x = 0.0F;
  float y = 0.0F;
  float theta = 0.0F;
};

/// Parameters of kernels for a map and points, relative to the anchor cell; values above the cap count as the cap.
PoseCost::Params pose_cost_params(const GlobalField& map, CellIndex anchor, std::size_t points, std::uint32_t cap,
                                  Interpolation interpolation, CostForm form);

/// Result of a minimiser's descent.
struct LocalMinimum {
  CellPose pose;
  std::uint32_t cost = 0;
  std::uint32_t evaluations = 0;
  StopReason stop = StopReason::kNotRun;
};

class Objective {
 public:
  /// The map must outlive this. Without memory() it lies on a device: then batches and descents along the slope only.
  Objective(const GlobalField& map, Interpolation interpolation, CostForm form);

  /// Sets the cell, in map cells, that poses are relative to.
  void set_anchor(CellIndex map_cell) { anchor_ = map_cell; }
  /// The points that count; they must live as long as they are used.
  void set_points(std::span<const PointCells> points) { points_ = points; }
  /// Field values are capped at this, 1/256 cell.
  void set_cap(std::uint32_t cap) { cap_ = cap; }
  /// Quadratic cost around a mean; each part is limited, so that a plainly wrong prediction does not pull.
  void set_prior(const PriorParams& prior) { prior_ = prior; }

  /// Costs of a batch of poses, prior included; one dispatch on the backend when the batch is large.
  void evaluate(std::span<const CellPose> poses, std::span<std::uint32_t> costs) {
    evaluate(poses, costs, interpolation_);
  }
  void evaluate(std::span<const CellPose> poses, std::span<std::uint32_t> costs, Interpolation interpolation);
  std::uint32_t evaluate(const CellPose& pose);
  /// Runs a simplex from the pose on this thread and returns its end; the cost and the prior of `walk` must be those
  /// below.
  PolishedPose descend(const CellPose& start, const PoseSimplex::Params& walk);
  /// Descents along the slope of the bilinear field from each pose, in place, and the field under all points at each
  /// end, nearest cell, in rows of PoseDescent::row_of(points). Where the map lies: on this thread, or in one dispatch.
  /// Grid and prior of `descent` are those of this objective.
  void descend(PoseDescent::Params descent, std::span<PolishedPose> poses, std::span<std::uint16_t> values);

  /// Kernel parameters of this objective.
  [[nodiscard]] PoseCost::Params cost_params() const { return params(interpolation_, points_.size()); }
  [[nodiscard]] const PriorParams& prior_params() const { return prior_; }

  /// Field value under each point, nearest cell; no coordinate may be NaN.
  void residuals(const CellPose& pose, std::span<const PointCells> points, std::span<std::uint16_t> values) const;
  [[nodiscard]] std::uint32_t prior_cost(const CellPose& pose) const;

  [[nodiscard]] CellPose to_cells(const Pose2& T_map_base) const;
  [[nodiscard]] Pose2 to_metres(const CellPose& pose) const;
  [[nodiscard]] std::span<const PointCells> points() const { return points_; }
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }
  [[nodiscard]] const DeviceInfo& device() const { return backend_->device(); }

 private:
  void upload(Buffer& buffer, std::span<const std::byte> bytes);
  [[nodiscard]] PoseCost::Params params(Interpolation interpolation, std::size_t points) const {
    return pose_cost_params(*map_, anchor_, points, cap_, interpolation, form_);
  }

  Backend* backend_;
  const GlobalField* map_;
  Interpolation interpolation_;
  CostForm form_;
  CellIndex anchor_{};
  std::span<const PointCells> points_;
  std::uint32_t cap_ = 0;
  PriorParams prior_;
  std::vector<PoseCandidate> candidates_;
  Buffer point_buffer_;
  Buffer candidate_buffer_;
  Buffer cost_buffer_;
  Buffer pose_buffer_;
  Buffer value_buffer_;
  std::uint64_t evaluations_ = 0;
};

/// Converts a pose in cells around an anchor to metres.
inline Pose2 pose_in_metres(const CellPose& pose, CellIndex anchor, double resolution_m) {
  return {(static_cast<double>(pose.x) + anchor.x) * resolution_m,
          (static_cast<double>(pose.y) + anchor.y) * resolution_m, wrap_angle(static_cast<double>(pose.theta))};
}

// Fit of a scan to a map at some poses, wherever the map lives. Frame: map. Not thread-safe. Cost: one evaluation a
// pose.

/// The mean distance of the points from the map at two poses, metres, each capped at `farthest_m`. Throws DeviceError
/// if the map's device fails.
std::array<double, 2> mean_distances_m(const GlobalField& map, std::span<const PointCells> points,
                                       const std::array<Pose2, 2>& poses, double farthest_m);

/// True if the points fit about as well at `pose` as at `matched`, for example in a bare corridor, along which a match
/// can slide at almost no cost. Throws as the above.
bool fits_about_as_well(const GlobalField& map, std::span<const PointCells> points, const Pose2& pose,
                        const Pose2& matched);

}  // namespace gdtslam
