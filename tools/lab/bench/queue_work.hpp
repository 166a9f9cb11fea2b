// What the rows of the group `work` count: what mapping a log asks of a device, for scans that become keyframes and for
// the others: kernels, barriers, copies, waits, and how long a scan takes. The counts depend on the log, the
// configuration and the device's shaders alone, the times on the machine. Seconds, bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"

namespace gdtslam {

/// Scans of one kind.
struct ScanWork {
  std::uint64_t scans = 0;
  std::uint64_t windows = 0;
  std::uint64_t evaluations = 0;  ///< poses costed: samples of the windows, and steps of all descents
  QueueWork work;                 ///< all together
  std::vector<double> scan_s;     ///< from a scan's coming to its pose
  std::vector<double> device_s;   ///< of the device's clock, of the last submission that a scan waited for
};

struct WorkBench {
  ScanWork keyframes;
  ScanWork others;
};

/// By the log's matcher. Throws InputError, FileError, DeviceError; Error(kInterrupted).
WorkBench run_work(const BenchLog& log, VulkanBackend& backend);

}  // namespace gdtslam
