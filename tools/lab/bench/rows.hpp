// Rows of `gdtslam-lab bench`, registered with google-benchmark, which chooses the iterations, repeats, filters and
// writes JSON. A row is named DEVICE/GROUP/NAME/VARIANT; google-benchmark adds the clock and the like behind that.
// Times are of one step; what a device's own clock says is the counter `device_s`. Ratios to peers and limits are left
// to who reads the JSON (tools/scripts/benchmarks.py).
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// What rows are measured on.
struct BenchTarget {
  Backend& backend;
  std::string on;  ///< "cpu", "vulkan:0"
  [[nodiscard]] bool is_cpu() const { return backend.device().kind == "cpu"; }
};

/// Registers a row. An error that it throws is shown in its place, and kept for rethrow_bench_error(); after an
/// interrupt the rows that are left are skipped.
benchmark::internal::Benchmark* add_row(const BenchTarget& target, std::string_view group, std::string_view name,
                                        std::string_view variant, std::function<void(benchmark::State&)> measure);

/// Throws what the first row that failed threw.
void rethrow_bench_error();

/// Something to be timed. Steps are put in line, then waited for together, so that what a wait costs does not count for
/// each of them.
struct Work {
  std::function<void()> step;
  std::function<void()> wait{};  ///< empty: a step is done when it returns
  std::function<double()>
      device_ns{};  ///< the device's time for what was waited for last, negative where it cannot tell
  int in_line = 1;
};

/// Steps on a backend: what waits for them, and the device's clock where it has one. The step ends by writing `last`.
Work work_on(Backend& backend, const Buffer& last, std::function<void()> step);

/// The device's time for the submission that was waited for last; empty where there is no such clock.
std::function<double()> clock_of(Backend& backend);

/// Times the work, whose step does so many units of it.
void time_work(benchmark::State& state, const Work& work, double units, std::string_view unit);

/// What several rows share, made by the first of them that is measured. `make` returns a std::shared_ptr.
template <class Make>
auto shared_by_rows(Make make) {
  using Pointer = decltype(make());
  return [make = std::move(make), made = std::make_shared<Pointer>()]() -> typename Pointer::element_type& {
    if (!*made) *made = make();
    return **made;
  };
}

/// A step by which an index visits each of `count` once, modulo it, and soon all parts of them.
std::size_t spreading_stride(std::size_t count);

/// Counts the points and keeps none.
struct CountingSink : CloudSink {
  void add(std::span<const CloudPoint> points) override { count += points.size(); }
  std::size_t count = 0;
};

/// A folder for files, in memory where the system has such a place: the disk is not what is measured.
std::string bench_folder();

/// What a scanner sees in a hall of 40 x 20 x 4 m: points on floor, ceiling and two walls, in the order of time.
Cloud bench_hall(std::size_t points);

/// A log that is mapped, and how.
struct BenchLog {
  std::string file;
  ReadOptions read;
  MapperConfig mapper;
  MapperOptions options;
  bool loops = true;    ///< `live`: else each scan is matched with one map of all that was seen
  double speed = 50.0;  ///< `live`: scans come so many times as fast as their stamps say; 0: when the last is done
};

/// Copies, and on a CPU loads from random places of tables that fit into the first cache, the second, or neither.
void add_limits(const BenchTarget& target);
/// The kernels on the benchmark cases of the shared list.
void add_kernels(const BenchTarget& target);
/// A scan from its points to its pose and into the map.
void add_scans(const BenchTarget& target);
/// The beams of a sweep of a nodding laser on their way to points of a cloud.
void add_sweeps(const BenchTarget& target);
/// Clouds written, read and thinned, and the peers: fwrite, fread, std::unordered_set.
void add_clouds(const BenchTarget& cpu);
/// Frames of a cloud and of a linkage, drawn without a display.
void add_frames(const BenchTarget& cpu);
/// Logs of every format read: a drive that is so large as an MCAP file that is not packed.
void add_log_formats(const BenchTarget& cpu, double megabytes);
/// Scans of a log looked for in its merged map, by the matcher `certified` and by a plain lattice of poses.
void add_certified(const BenchTarget& cpu, const BenchLog& log);
/// What each scan of a log takes as it comes.
void add_live(const BenchTarget& cpu, const BenchLog& log);
/// What mapping a log by the matcher `exhaustive` asks of a device.
void add_work(const BenchTarget& device, const BenchLog& log);

}  // namespace gdtslam
