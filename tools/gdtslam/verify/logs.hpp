// Whole logs through the mapper on one backend against another: hashes of map and trajectory, the host's copy of the
// map against the device's cells, and the hashes that the project ships. The second half of `gdtslam verify`; prints
// nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// The result that a log must give, on any host and device.
struct ExpectedRun {
  std::string matcher;
  bool with_loops = false;  ///< the whole of `map`, loops closed; else the mapper alone
  std::uint64_t scans = 0;
  std::string map_sha256;
  std::string trajectory_sha256;
  std::string cloud_sha256{};  ///< digest of a nodding laser's points; else empty
};

/// A sample log that comes with the project, and what it must give.
struct SampleLog {
  std::string path;
  std::vector<ExpectedRun> runs;
};
/// The logs of a flat laser and of one that nods. Throws FileError or InputError if the files are missing, damaged or
/// do not belong together.
std::vector<SampleLog> sample_logs();
/// Writes what `runs` gave as the expected results of a sample log.
void write_expected(const std::string& path, const std::string& log, const std::vector<ExpectedRun>& runs);

/// A log to map, and how.
struct LogTask {
  std::string log;
  std::string matcher;                  ///< name, as --matcher takes it
  bool with_loops = false;              ///< the same flag as in ExpectedRun
  std::optional<ExpectedRun> expected;  ///< shipped
  ReadOptions read{};
};

/// One run of a log on one backend.
struct LogRun {
  std::uint64_t scans = 0;
  std::string map_sha256;
  std::string trajectory_sha256;
  std::string cloud_sha256;  ///< set if the laser nods and loops are closed
  std::uint64_t dispatches = 0;
  std::uint64_t submissions = 0;
  double wall_s = 0.0;
  bool copy_is_equal = false;  ///< the host's copy of the map holds what the device's buffer holds, where it has one
};

/// Called with the scans so far and the share of the log (negative when unknown).
using LogProgress = std::function<void(std::uint64_t, double)>;

/// Maps with the defaults and this matcher. Throws Error(kInterrupted) when a signal comes, DeviceError when the device
/// fails: there is no falling back here.
LogRun run_log(const LogTask& task, Backend& backend, const LogProgress& progress);

/// The verdict on one log and matcher.
struct LogVerdict {
  LogTask task;
  LogRun reference;
  LogRun found;
  std::vector<std::string> faults;  ///< in words; empty when all is equal
};
LogVerdict judge(const LogTask& task, const LogRun& reference, const LogRun& found);

}  // namespace gdtslam
