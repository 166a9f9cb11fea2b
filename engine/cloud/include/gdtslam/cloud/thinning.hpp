// Voxel thinning and removal of floor and ceiling, for clouds of any length. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

/// Passes on the first point of each voxel. Voxels are cubes, one with its corner at the origin. Memory: 32 to 64 bytes
/// for each block of 4 x 4 x 4 voxels that has a point, half as much again for a moment while it grows: 2 to 6 bytes a
/// voxel of a surface. Throws InputError beyond max_voxels and for points farther than 2^20 voxels from the origin,
/// with advice; ConfigError for a voxel_m that is not positive. O(1) for each point.
class VoxelThinning : public CloudSink {
 public:
  VoxelThinning(double voxel_m, std::uint64_t max_voxels, CloudSink& next);
  ~VoxelThinning() override;
  void add(std::span<const CloudPoint> points) override;
  [[nodiscard]] std::uint64_t kept() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Floor and ceiling: the lowest and the highest large horizontal plane of a cloud, found robustly (tilt up to
/// max_tilt_rad, no fixed height).
struct LevelSurfaces {
  std::optional<PlanePatch> floor;
  std::optional<PlanePatch> ceiling;
};
/// Limits for floor and ceiling.
struct LevelSearch {
  double max_tilt_rad = 0.05;
  double thickness_m = 0.06;
  double min_share = 0.02;  ///< least share of all points for a surface
};
/// Normals point up. O(n log n).
LevelSurfaces find_level_surfaces(std::span<const CloudPoint> sample, const LevelSearch& search);

/// Passes on the points between floor and ceiling. Points within the margin of either are removed too.
class LevelRemoval : public CloudSink {
 public:
  LevelRemoval(const LevelSurfaces& surfaces, double margin_m, CloudSink& next);
  void add(std::span<const CloudPoint> points) override;
  [[nodiscard]] std::uint64_t removed() const { return removed_; }

 private:
  LevelSurfaces surfaces_;
  double margin_m_;
  CloudSink& next_;
  std::vector<CloudPoint> kept_;
  std::uint64_t removed_ = 0;
};

}  // namespace gdtslam
