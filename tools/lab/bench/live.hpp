// What `gdtslam bench live` measures: how long a mapper takes for each scan of a log that comes as it was recorded,
// only faster; with loops, while these are looked for beside it. The poses depend on the log and the configuration
// alone, the times on the machine. Seconds, bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

struct LiveBenchJob {
  std::string log;
  ReadOptions read;
  MapperConfig mapper;
  MapperOptions options;
  bool loops = true;    ///< else each scan is matched with one map of all that was seen
  double speed = 50.0;  ///< scans come so many times as fast as their stamps say; 0: each when the one before is done
};

/// One scan, from its coming to its pose.
struct LiveScan {
  std::size_t index = 0;
  double all_s = 0.0;
  double cpu_s = 0.0;     ///< of the thread that maps: what other work on the machine does not lengthen
  double waited_s = 0.0;  ///< for loops
  bool is_keyframe = false;
  StageTimes stages{};
  std::uint64_t windows = 0;      ///< searched
  std::uint64_t evaluations = 0;  ///< poses costed, one after the other
};

struct LiveBench {
  std::vector<LiveScan> scans;
  std::size_t late = 0;  ///< scans that came before the one before them was done
  double lasted_s = 0.0;
  LiveStatistics loops;
  std::uint64_t keyframes = 0;
  std::uint64_t peak_bytes = 0;  ///< the most memory that the process had by the end, in RAM
};

/// The backend is the CPU's. Throws InputError, FileError; Error(kInterrupted) when stop() became true.
LiveBench run_live(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop);

/// The scans in the order of the log in so many pieces of equal length, or less: what grows with the map is seen.
struct LivePart {
  std::size_t first = 0;
  std::size_t scans = 0;
  std::size_t keyframes = 0;
  double scan_cpu_s = 0.0;        ///< mean of those that are no keyframes; 0 where there are none
  double keyframe_cpu_s = 0.0;    ///< mean of the keyframes, from scan to pose; likewise
  double keyframe_merge_s = 0.0;  ///< of that, the local field and its merge, in wall time
};
std::vector<LivePart> live_parts(const std::vector<LiveScan>& scans, std::size_t pieces);

/// As the command prints it, for people or JSON. Throws as run_live().
std::string bench_live(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop, bool is_json);

}  // namespace gdtslam
