// What `gdtslam bench work` counts: what mapping a log asks of a device, for scans that become keyframes and for the
// others: kernels, barriers, copies, waits, and how long a scan takes. The counts depend on the log, the configuration
// and the device's shaders alone, the times on the machine. Seconds, bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

struct WorkBenchJob {
  std::string log;
  ReadOptions read;
  MapperConfig mapper;  ///< with the matcher `exhaustive`: the others ask a device for nothing
};

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

/// Throws InputError, FileError, DeviceError; Error(kInterrupted) when stop() became true.
WorkBench run_work(const WorkBenchJob& job, VulkanBackend& backend, const std::function<bool()>& stop);

/// As the command prints it, for people or JSON. Throws as run_work().
std::string bench_work(const WorkBenchJob& job, VulkanBackend& backend, const std::function<bool()>& stop,
                       bool is_json);

}  // namespace gdtslam
