// Which scans of a log are localised, and all of them at once: scans do not depend on each other, so several threads
// take them, and the result is in the log's order whatever their number. One run belongs to one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "reference.hpp"
#include "run.hpp"

namespace gdtslam {

/// One scan, every so many of them, or so many at random.
struct ScanChoice {
  std::uint64_t first = 0;   ///< index in the log
  std::uint64_t every = 0;   ///< 0: the first alone
  std::uint64_t random = 0;  ///< 0: not at random
  std::uint64_t seed = 1;
};

struct LocalizeJob {
  std::string log;
  /// Of a drive that is followed while it goes on, in place of what lies under the log's name: nothing is read ahead to
  /// see whether the laser nods.
  LiveLog live_log{};
  ReadOptions read;
  ScanChoice choice;
  unsigned threads = 1;               ///< of the CPU; a device takes one scan after the other
  std::optional<MergedScans> merged;  ///< those near them in time do not count
  std::optional<LocalizeTruth> reference;
  std::optional<RunReader> run{};  ///< that of the map, where the two above needed it
};

struct Localized {
  std::vector<LocalizedScan> scans;     ///< in the log's order
  std::uint64_t candidates = 0;         ///< among which were chosen
  std::uint64_t left_out = 0;           ///< near a scan that went into the map
  std::uint64_t without_reference = 0;  ///< not drawn, as the reference does not have them
  bool nods = false;                    ///< the log tells how a mount tilts the laser
  std::vector<LogReader::Warning> warnings;
  bool interrupted = false;
};

/// Called with the number of scans done and the share (negative when unknown).
using LocalizeProgress = std::function<void(std::uint64_t, double)>;
/// Ends early when stop() is true, after the scans in hand. Throws InputError, FileError, DeviceError; UsageError where
/// a log that cannot be read twice would have to be.
Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop);

}  // namespace gdtslam
