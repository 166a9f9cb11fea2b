// What `gdtslam bench` measures on a backend: the kernels on the benchmark cases of the shared list, whole distance
// transforms, whole scans and sweeps, clouds in files and thinned, and OpenCV's distance transform beside them when the
// build has it. Times are taken on a machine that does other things as well: of many samples the median counts and the
// spread is told.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

struct TimingOptions {
  int samples = 15;         ///< at most
  double sample_s = 0.004;  ///< a sample repeats the work until it takes this long
  double longest_s = 2.0;   ///< no further sample after this long, once there are kFewestSamples
  static constexpr int kFewestSamples = 3;
};

/// Something to be timed. Steps are put in line, then waited for together, so that what a wait costs does not count for
/// each of them; the times are those of one step.
struct Work {
  std::function<void()> step;
  std::function<void()> wait{};  ///< empty: a step is done when it returns
  std::function<double()>
      device_ns{};  ///< the device's time for what was waited for last, negative where it cannot tell
  int most_in_line = 1 << 20;
};

/// Seconds for one step.
struct Timing {
  double wall_s = 0.0;     ///< median
  double cpu_s = 0.0;      ///< median over the samples, all threads of the process
  double fastest_s = 0.0;  ///< CPU time of the fastest and of the slowest sample
  double slowest_s = 0.0;
  std::optional<double> device_s;  ///< median, by the device's clock
  int samples = 0;
  std::vector<double> wall_samples_s;  ///< in the order in which they were taken
  std::vector<double> cpu_samples_s;
  std::vector<double> device_samples_s;  ///< empty where the clock does not tell, if only for one of them
};

/// Throws Error(kInterrupted) where a signal came in between.
Timing measure(const Work& work, const TimingOptions& options);

/// Counts the points and keeps none.
struct CountingSink : CloudSink {
  void add(std::span<const CloudPoint> points) override { count += points.size(); }
  std::size_t count = 0;
};

/// One measurement.
struct BenchRow {
  std::string group;  ///< "limit", "kernel", "transform", "scan", "sweep", "cloud", "viewer", "peer"
  std::string name;
  std::string variant;
  std::string unit;  ///< of the work: cell, look-up, value, point
  double work = 0.0;
  Timing timing;
  std::optional<double> copy_ratio;    ///< time that the device takes to copy the bytes read and written, over the time
  std::optional<double> load_ratio{};  ///< look-ups a second, over the most loads a second that the machine makes
  std::optional<double> times_opencv;  ///< OpenCV's CPU time over ours, for the same result
  std::optional<std::uint64_t> different;  ///< cells that differ from the exact transform
};

/// Measures what does so many units of work. Throws as measure().
BenchRow measured_row(std::string_view group, std::string_view name, std::string_view variant, std::string_view unit,
                      double work, const Work& timed, const TimingOptions& options);

/// Whose seconds a rate is per: CPU time where a CPU does the work, be it as a Vulkan device; else the device's own
/// clock; else wall time.
enum class Basis : std::uint8_t { kCpu, kDevice, kWall };
Basis basis_of(const Backend& backend);
/// That of a measurement on such a backend: wall time where the device's clock did not tell.
inline Basis basis_of(const Timing& timing, Basis backend) {
  return backend == Basis::kDevice && !timing.device_s ? Basis::kWall : backend;
}
/// As JSON has it: "cpu", "device", "wall".
constexpr std::string_view to_string(Basis basis) {
  return basis == Basis::kCpu ? "cpu" : basis == Basis::kDevice ? "device" : "wall";
}
/// The time of a measurement on its basis.
double seconds_of(const Timing& timing, Basis basis);
/// The samples that it is the median of.
inline const std::vector<double>& samples_of(const Timing& timing, Basis basis) {
  if (basis == Basis::kCpu) return timing.cpu_samples_s;
  return basis == Basis::kDevice ? timing.device_samples_s : timing.wall_samples_s;
}

/// A step by which an index comes by each of `count` once, modulo it, and soon by all parts of them.
std::size_t spreading_stride(std::size_t count);

/// What tells the device's time for the submission that was waited for last; empty where there is no such clock.
std::function<double()> clock_of(Backend& backend);

/// Steps on a backend: what waits for them, and the device's clock where it has one. The step ends by writing `last`.
Work work_on(Backend& backend, const Buffer& last, std::function<void()> step);

/// Copying so many bytes, read and written together: memcpy on the CPU, a copy between two buffers of its own memory on
/// a device.
Timing copy_timing(Backend& backend, std::size_t traffic, const TimingOptions& options);

/// A row of the group "limit": so many bytes read and as many written by memcpy.
BenchRow copy_row(std::string_view variant, std::size_t bytes, const TimingOptions& options);

/// What this machine does at most, on the CPU with the backend's instruction set: copies, and loads from random places
/// of tables that fit into the first cache, the second, or neither.
std::vector<BenchRow> bench_limits(Backend& backend, const TimingOptions& options);

/// States load_ratio of the rows that count look-ups.
void compare_with_limits(std::span<BenchRow> rows, std::span<const BenchRow> limits);

/// The kernels whose name contains the filter.
std::vector<BenchRow> bench_kernels(Backend& backend, std::string_view filter, const TimingOptions& options);

/// The largest square, of `most` cells a side at most, whose transforms need no buffer of more bytes than that.
std::uint32_t largest_transform(std::size_t buffer_bytes, std::uint32_t most);

/// Whole transforms of a square of `size` cells with walls on 1.5 % of them; on the CPU the peers too.
std::vector<BenchRow> bench_transforms(Backend& backend, std::uint32_t size, const TimingOptions& options);

/// What a scanner sees in a hall of 40 x 20 x 4 m: points on floor, ceiling and two walls, in the order of time.
Cloud bench_hall(std::size_t points);

/// Frames of a cloud and of a linkage, drawn without a display; nothing where the build has no viewer, and a remark
/// where nothing here can draw.
std::vector<BenchRow> bench_viewer(const TimingOptions& options);

/// Clouds written, read and thinned, and the peers: fwrite, fread, std::unordered_set. On the CPU only.
std::vector<BenchRow> bench_clouds(const TimingOptions& options);

/// What a scan costs from its points to its pose and into the map.
std::vector<BenchRow> bench_scans(Backend& backend, const TimingOptions& options);

/// What the beams of a sweep of a nodding laser cost on their way to points of a cloud.
std::vector<BenchRow> bench_sweeps(Backend& backend, const TimingOptions& options);

/// A line of the table of jump flooding's errors.
struct FloodErrorRow {
  std::uint32_t size = 0;
  std::string seeds;  ///< what the obstacles look like
  std::string variant;
  std::uint64_t passes = 0;
  std::uint64_t wrong_cells = 0;
  double wrong_share = 0.0;
  double largest_cells = 0.0;
};
/// Errors of the four variants against the exact transform, on walls and on cells scattered over 1 % of the square.
std::vector<FloodErrorRow> flood_errors(Backend& backend, std::uint32_t size);

/// The version of OpenCV that is measured, or empty.
std::string opencv_version();

/// What `gdtslam bench certified` measures: a log is mapped, and scans of it are looked for again in its merged map, in
/// windows of growing size whose centres are off the pose that mapping found, by the matcher `certified` and by a plain
/// lattice of poses. Frame: map. One thread; the poses depend on the log and the configuration alone, the times on the
/// machine.
struct CertifiedBenchJob {
  std::string log;
  ReadOptions read;
  MapperConfig mapper;
  std::uint64_t scans = 100;  ///< that are looked for, evenly over the log
  double gap_m = 0.005;
  double lattice_s = 5.0;  ///< CPU time that the peer may take for a window, of one scan at least; 0: no peer
};

/// As the command prints it, a table for people or JSON. The backend is the CPU's. Throws InputError, FileError;
/// Error(kInterrupted) when stop() became true.
std::string bench_certified(const CertifiedBenchJob& job, Backend& backend, const std::function<bool()>& stop,
                            bool is_json);

/// What `gdtslam bench logs` measures: a drive is written in every format into a temporary folder, in memory where the
/// system has such a place, and each file is read as `map` reads it.
struct LogBenchJob {
  double megabytes = 32.0;  ///< of the drive as an MCAP file that is not packed; text takes about twice that
  TimingOptions timing;
};

/// As the command prints it, for people or JSON. Throws FileError; Error(kInterrupted) when stop() became true.
std::string bench_logs(const LogBenchJob& job, const Backend& backend, const std::function<bool()>& stop, bool is_json);

}  // namespace gdtslam
