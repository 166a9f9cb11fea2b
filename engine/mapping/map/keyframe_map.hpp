// The map on one backend, into which keyframes are merged. Not thread-safe.
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
  /// map.max_megacells limits the map on the CPU; on a device its memory is the limit.
  KeyframeMap(const MapperConfig& config, Backend& backend);
  /// Paper equation (1), and (9) to (11); grows the map if needed. Throws InputError if the map would become too large,
  /// DeviceError if the backend fails; its cells are unchanged then.
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

/// A map on its own CPU backend, with the same lifetime, so it may be passed to another thread. One thread at a time
/// while it is made; then it is constant. Cost: some 0.5 ms a keyframe.
class SeparateMap {
 public:
  explicit SeparateMap(const MapperConfig& config);
  /// Paper equations (1) and (9) to (11); no effect without points. Throws InputError if the map would exceed
  /// map.max_megacells.
  void merge(const std::vector<Point2>& points_base_m, const Pose2& T_map_base);
  [[nodiscard]] const GlobalField& field() const { return map_.field; }

 private:
  MapConfig config_;
  std::unique_ptr<Backend> cpu_;
  KeyframeMap map_;
};

}  // namespace gdtslam
