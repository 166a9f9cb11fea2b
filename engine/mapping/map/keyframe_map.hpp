// The map on one backend, where keyframes are merged. Not thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/match.hpp"
#include "local_field.hpp"

namespace gdtslam {

struct KeyframeMap {
  /// map.max_megacells counts on the CPU; a device takes what it has memory for.
  KeyframeMap(const MapperConfig& config, Backend& backend);
  /// Paper equation (1), and (9) to (11); grows the map where it has to. Throws InputError where the map would become
  /// too large, DeviceError where the backend fails; its cells are as before then.
  void merge(const KeyframeCells& keyframe, StageTimes& stages);

  GlobalField field;
  LocalField local;
  MergeStep step;
};

/// Adds the time until the end of its scope to a stage.
class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(&seconds), start_(Clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { *seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double* seconds_;
  Clock::time_point start_;
};

/// A map on a CPU backend of its own, which lives as long as it does: it may be handed on, also to another thread. One
/// thread at a time while it is made; then it stays as it is. Cost: some 0.5 ms a keyframe.
class SeparateMap {
 public:
  explicit SeparateMap(const MapperConfig& config);
  /// Paper equations (1) and (9) to (11); nothing where there are no points. Throws InputError where the map would be
  /// beyond map.max_megacells.
  void merge(const std::vector<Point2>& points_base_m, const Pose2& T_map_base);
  [[nodiscard]] const GlobalField& field() const { return map_.field; }

 private:
  MapConfig config_;
  std::unique_ptr<Backend> cpu_;
  KeyframeMap map_;
};

}  // namespace gdtslam
