// `gdtslam map` for who needs a run without the command line: all defaults but what the job says. Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "device_option.hpp"
#include "map_run.hpp"
#include "scan_stream.hpp"

namespace gdtslam {

struct MapLogJob {
  std::vector<std::string> logs;
  std::string folder;               ///< of the run
  std::string linkage;              ///< preset or file; empty: as `gdtslam map` finds it
  bool is_temporary = false;        ///< for another command: without pictures, and without a word of an interruption
  bool quiet = false;               ///< no progress line, no remarks
  std::vector<std::string> sets{};  ///< as --set has them
  ScanRange range{};
  DeviceOptions device{};
  MapRun::Progress progress{};  ///< where given it is called instead of the progress line
};
/// Maps the logs as one, without a summary; the exit code of `gdtslam map`. Throws as that does.
int map_log(const MapLogJob& job);
/// What the log tells, near its beginning, of how its laser nods.
NodKind nod_kind_of(const std::vector<std::string>& logs);

}  // namespace gdtslam
