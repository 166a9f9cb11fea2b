// The folder of a run, read on demand, also by several threads at once.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam.h"

struct gdtslam_run {
  explicit gdtslam_run(const std::string& folder);

  gdtslam::RunReader reader;
  std::string report;
  std::string trajectory_sha256;
  /// Does not move once it was read or made; under the lock.
  std::optional<std::vector<gdtslam_stamped_pose>> trajectory;
  std::mutex mutex;
};
