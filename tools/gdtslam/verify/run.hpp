// `gdtslam verify` as a function: what to compare, and the findings. Prints nothing but progress. The mapper maps whole
// logs (logs.cpp) on two backends and compares hashes of map and trajectory, the host's copy of the map with the
// device's cells, and the expected hashes that the project ships.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "kernels.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"

namespace gdtslam {

/// The expected result of a log on any host and device.
struct ExpectedRun {
  std::string matcher;
  bool with_loops = false;  ///< `map` as a whole, with loops closed; else the mapper alone
  std::uint64_t scans = 0;
  std::string map_sha256;
  std::string trajectory_sha256;
  std::string cloud_sha256{};  ///< digest of a nodding laser's points; else empty
};

/// A sample log of the project, with its expected results.
struct SampleLog {
  std::string path;
  std::vector<ExpectedRun> runs;
};
/// The sample logs of a flat and of a nodding laser. Throws FileError or InputError if the files are missing, damaged
/// or do not belong together.
std::vector<SampleLog> sample_logs();
/// Writes the results of `runs` as the expected results of a sample log.
void write_expected(const std::string& path, const std::string& log, const std::vector<ExpectedRun>& runs);

/// A log to map, with its settings.
struct LogTask {
  std::string log;
  std::string matcher;                  ///< name as in --matcher
  bool with_loops = false;              ///< the same flag as in ExpectedRun
  std::optional<ExpectedRun> expected;  ///< shipped result
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
  bool copy_is_equal = false;  ///< the host's copy of the map equals the device's buffer, if any
};

/// Receives the number of scans so far and the share of the log (negative if unknown).
using LogProgress = std::function<void(std::uint64_t, double)>;

/// Maps with the defaults and this matcher. Throws Error(kInterrupted) on a signal, DeviceError if the device fails:
/// there is no fallback here.
LogRun run_log(const LogTask& task, Backend& backend, const LogProgress& progress);

/// The verdict on one log and matcher.
struct LogVerdict {
  LogTask task;
  LogRun reference;
  LogRun found;
  std::vector<std::string> faults;  ///< in words; empty if all is equal
};
LogVerdict judge(const LogTask& task, const LogRun& reference, const LogRun& found);

struct VerifyOptions {
  DeviceOptions device;
  std::string filter{};  ///< part of kernels' names; "logs": only logs; empty: everything
  std::uint64_t seed = 1;
  std::uint32_t random_cases = 0;
  bool large = false;
  std::vector<std::string> logs{};  ///< in addition to the sample log
  RecordingOptions recording{};     ///< topics of these logs
  bool quiet = false;               ///< draws no progress
};

/// The findings about one backend.
struct TargetReport {
  std::string name;  ///< "vulkan:0", "cpu avx2"
  DeviceInfo device;
  bool is_vulkan = false;
  std::vector<KernelVerdict> kernels;
  DeviceWork work;
  std::vector<LogVerdict> logs;
  std::string failure{};  ///< failure of its driver, which ended the verification
  std::string error{};    ///< other error that ended it
  [[nodiscard]] std::uint64_t cases() const;
  [[nodiscard]] std::uint64_t differences() const;
};

struct VerifyReport {
  DeviceInfo reference;
  std::vector<TargetReport> targets;
  std::optional<DeviceError> failure{};  ///< failure of the last target's driver; later targets were not verified
  std::exception_ptr error{};            ///< other error that ended the last target's verification
  double wall_s = 0.0;
  [[nodiscard]] std::uint64_t differences() const;
  [[nodiscard]] bool passed() const { return differences() == 0 && !failure && !error; }
};

/// The default matcher and those that run on the device as a whole.
std::vector<std::string> verified_matchers();

/// Compares the device with the CPU, or the CPU's instruction sets and threads with the baseline. Throws
/// UnavailableError for a missing device or instruction set, DeviceError if it fails on opening, UsageError for a
/// filter without a match, FileError for a log that cannot be opened, and Error(kInterrupted). Later failures are in
/// the report.
VerifyReport run_verify(const VerifyOptions& options);

/// Maps the sample log, or the nodding one, on the CPU and writes the results as the expected ones. The name of the
/// file selects the log. Throws FileError.
void write_expected_results(const VerifyOptions& options, const std::string& path);

}  // namespace gdtslam
