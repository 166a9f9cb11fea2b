// The options of a caller as a configuration.
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
  std::string path, doc, value;        ///< last texts given to the caller
};

namespace gdtslam::c {

/// The defaults for NULL. Throws ConfigError if values contradict each other or are out of bounds.
Settings read_settings(const gdtslam_options* options);

/// Throws UsageError. 0 is as the command without --threads: one, and another one that searches loops; UINT32_MAX: one
/// per processor.
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
