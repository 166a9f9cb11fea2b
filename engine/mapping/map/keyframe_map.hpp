// The map on one backend, where keyframes are merged. Not thread-safe.
#pragma once

#include <chrono>

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

}  // namespace gdtslam
