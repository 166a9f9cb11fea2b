// The scans of a log that are localised, all of them at once: scans do not depend on each other, so several threads
// take them, and the result is in the log's order whatever their number. One run belongs to one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "run.hpp"

namespace gdtslam {

/// One scan, or every so many of them.
struct ScanChoice {
  std::uint64_t first = 0;  ///< index in the log
  std::uint64_t every = 0;  ///< 0: the first alone
};

struct LocalizeJob {
  std::string log;
  /// Input of a drive that is followed while it goes on, in place of the file with the log's name: nothing is read
  /// ahead to see whether the laser nods.
  LiveLog live_log{};
  ReadOptions read;
  ScanChoice choice;
  unsigned threads = 1;  ///< of the CPU; a device takes one scan after the other
};

struct Localized {
  std::vector<LocalizedScan> scans;  ///< in the log's order
  bool nods = false;                 ///< the log tells how a mount tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with the number of scans done and the share (negative when unknown).
using LocalizeProgress = std::function<void(std::uint64_t, double)>;
/// Ends early when stop() is true, after the scans in hand. Throws InputError, FileError, DeviceError.
Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop);

}  // namespace gdtslam
