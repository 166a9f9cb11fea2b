// `gdtslam verify` as a value: what to compare with what, and what was found. Prints nothing but progress.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "kernels.hpp"
#include "logs.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"

namespace gdtslam {

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
