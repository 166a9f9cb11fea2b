// Compares kernels on one backend with another, case by case, and proves that a device did its part itself. The core of
// `gdtslam verify`; prints nothing. One verifier belongs to one thread. The proof: no CPU kernel ran meanwhile
// (cpu_kernel_calls()), each case was one dispatch and at least one submission, the device's memory has no host view,
// and each kernel was dispatched once with decoys instead of its CPU functions. Decoys write nothing and record calls.
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
  std::uint64_t values = 0;     ///< values compared: all that the kernel may write
  std::uint64_t different = 0;  ///< values that differ
  std::uint64_t largest = 0;    ///< largest difference of two values, as unsigned integers
  std::uint64_t faults = 0;     ///< other failures: a guard or an input was written, or the CPU did work
  std::string first;            ///< the first fault in words; empty if there is none
  [[nodiscard]] std::uint64_t differences() const { return different + faults; }
};

/// Counts of the device.
struct DeviceWork {
  std::uint64_t dispatches = 0;
  std::uint64_t submissions = 0;
  std::uint64_t decoys = 0;  ///< kernels that were right without their CPU functions
};

/// Whether the CPU must have no part in the verified backend's work.
enum class Proof : std::uint8_t { kNone, kDeviceDidIt };

class KernelVerifier {
 public:
  KernelVerifier(Backend& reference, Backend& device, Proof proof);

  /// Runs a case on both backends.
  void check(const KernelCase& kernel_case);
  /// Call after the last case: a kernel that no case proved is a fault.
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
  std::vector<std::string> proven_;  ///< kernels run with a decoy
  DeviceWork work_;
};

}  // namespace gdtslam
