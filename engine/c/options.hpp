// The options of a caller as the configuration has them.
#pragma once

#include <string>
#include <vector>

#include "gdtslam.h"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/runs/settings.hpp"

struct gdtslam_options {
  gdtslam_options() : table(gdtslam::option_table(settings)) {}
  gdtslam_options(const gdtslam_options&) = delete;
  gdtslam_options& operator=(const gdtslam_options&) = delete;
  ~gdtslam_options() = default;

  gdtslam::Settings settings;
  std::vector<gdtslam::Option> table;  ///< rows for the settings above
  std::string path, doc, value;        ///< that were last given out
};

namespace gdtslam::c {

/// The defaults for NULL. Throws ConfigError where they contradict each other or are out of their bounds.
Settings read_settings(const gdtslam_options* options);

/// Throws UsageError. As the command without --threads: one, and another one looks for loops; UINT32_MAX: one per
/// processor.
struct ThreadChoice {
  unsigned count = 1;
  bool loops_beside = true;
};
inline constexpr uint32_t kMostThreads = 1024;
inline ThreadChoice choose_threads(uint32_t threads) {
  if (threads == 0) return {};
  if (threads != UINT32_MAX && threads > kMostThreads) {
    throw UsageError(std::to_string(threads) + " threads: at most " + std::to_string(kMostThreads));
  }
  return {threads == UINT32_MAX ? 0U : threads, threads != 1};
}

}  // namespace gdtslam::c
