// `gdtslam verify` as a value: what to compare with what, and what was found. Prints nothing but progress.
// Whole logs (logs.cpp) go through the mapper on one backend against another: hashes of map and trajectory, the host's
// copy of the map against the device's cells, and the hashes that the project ships.
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

struct VerifyOptions {
  DeviceOptions device;
  std::string filter{};  ///< kernels whose name contains this; "logs": the logs alone; empty: everything
  std::uint64_t seed = 1;
  std::uint32_t random_cases = 0;
  bool large = false;
  std::vector<std::string> logs{};  ///< beside the sample log
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
  std::string error{};    ///< another one that ended it
  [[nodiscard]] std::uint64_t cases() const;
  [[nodiscard]] std::uint64_t differences() const;
};

struct VerifyReport {
  DeviceInfo reference;
  std::vector<TargetReport> targets;
  std::optional<DeviceError> failure{};  ///< failure of the last target's driver; later targets were not verified
  std::exception_ptr error{};            ///< another one that ended the last target's verification
  double wall_s = 0.0;
  [[nodiscard]] std::uint64_t differences() const;
  [[nodiscard]] bool passed() const { return differences() == 0 && !failure && !error; }
};

/// The default matcher and those that work on the device as a whole.
std::vector<std::string> verified_matchers();

/// Compares the device with the CPU, or, for the CPU, its instruction sets and threads with the baseline. Throws
/// UnavailableError for a device or an instruction set that is not there, DeviceError when it fails before there is
/// anything to verify, UsageError for a filter that leaves nothing, FileError for a log that cannot be opened, and
/// Error(kInterrupted). What fails later is in the report.
VerifyReport run_verify(const VerifyOptions& options);

/// Maps the sample log, or the one that nods, on the CPU and writes what it gave as what it must give. Which one the
/// name of the file says. Throws FileError.
void write_expected_results(const VerifyOptions& options, const std::string& path);

}  // namespace gdtslam
