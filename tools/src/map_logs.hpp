// `gdtslam map` for who needs a run without the command line: all defaults. Not thread-safe.
#pragma once

#include <string>
#include <vector>

namespace gdtslam {

struct MapLogJob {
  std::vector<std::string> logs;
  std::string folder;         ///< of the run
  std::string linkage;        ///< preset or file; empty: as `gdtslam map` finds it
  bool is_temporary = false;  ///< without the pictures that a run has beside it
  bool quiet = false;         ///< no progress, no remarks
};
/// Maps the logs as one, without a summary; the exit code of `gdtslam map`. Throws as that does.
int map_log(const MapLogJob& job);
/// Whether the log tells, near its beginning, how its laser nods.
bool log_nods(const std::vector<std::string>& logs);

}  // namespace gdtslam
