// Kernels on one backend against the same kernels on another, case by case, and the proof that a device did its part
// itself. The core of `gdtslam verify`; prints nothing. One verifier belongs to one thread.
//
// That a device did it: no CPU kernel ran while it worked (cpu_kernel_calls()), each case was one dispatch and at least
// one submission of its own, its memory has no host view, and each kernel was dispatched once with decoys in place of
// its CPU functions, which write nothing and note that they were called.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// The verdict on one kernel.
struct KernelVerdict {
  std::string kernel;
  std::uint64_t cases = 0;
  std::uint64_t values = 0;     ///< compared: those that the kernel may write
  std::uint64_t different = 0;  ///< values that differ
  std::uint64_t largest = 0;    ///< largest difference of two values, as unsigned integers
  std::uint64_t faults = 0;     ///< other failures: a guard or an input written, a part played by the CPU
  std::string first;            ///< the first of all that is wrong, in words; empty when nothing is
  [[nodiscard]] std::uint64_t differences() const { return different + faults; }
};

/// Counts of the device.
struct DeviceWork {
  std::uint64_t dispatches = 0;
  std::uint64_t submissions = 0;
  std::uint64_t decoys = 0;  ///< kernels that gave the right result without their CPU functions
};

/// Whose results count, and whether the CPU must have no part in what the other one does.
enum class Proof : std::uint8_t { kNone, kDeviceDidIt };

class KernelVerifier {
 public:
  KernelVerifier(Backend& reference, Backend& device, Proof proof);

  /// Runs a case on both.
  void check(const KernelCase& kernel_case);
  /// Call after the last case: a kernel that no case could prove is a fault.
  void finish();

  [[nodiscard]] const std::vector<KernelVerdict>& verdicts() const { return verdicts_; }
  [[nodiscard]] const DeviceWork& work() const { return work_; }

 private:
  KernelVerdict& find_verdict(const KernelInfo& kernel);
  void compare(const KernelCase& kernel_case, const CaseOutcome& expected, const CaseOutcome& found,
               const std::string& how);
  CaseOutcome run_on_device(const KernelCase& kernel_case);
  void try_decoy(KernelCase kernel_case, const CaseOutcome& expected);
  void add_fault(const KernelCase& kernel_case, const std::string& what);

  Backend& reference_;
  Backend& device_;
  Proof proof_;
  std::vector<KernelVerdict> verdicts_;
  std::vector<std::string> proven_;  ///< kernels whose decoy was tried
  DeviceWork work_;
};

}  // namespace gdtslam
