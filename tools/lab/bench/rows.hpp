// Rows of `gdtslam-lab bench`, registered with google-benchmark, which chooses iterations, repeats and filters and
// writes JSON. A row is named DEVICE/GROUP/NAME/VARIANT; google-benchmark appends the clock and the like. Times are per
// step; the counter `device_s` is the time by the device's own clock. tools/scripts/benchmarks.py computes ratios to
// limits from the JSON.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// A device on which rows are measured.
struct BenchTarget {
  Backend& backend;
  std::string on;  ///< "cpu", "vulkan:0"
  [[nodiscard]] bool is_cpu() const { return backend.device().kind == "cpu"; }
};

/// Registers a row. An error in it is shown instead of its times and kept for rethrow_bench_error(); after an interrupt
/// the remaining rows are skipped.
benchmark::internal::Benchmark* add_row(const BenchTarget& target, std::string_view group, std::string_view name,
                                        std::string_view variant, std::function<void(benchmark::State&)> measure);

/// Rethrows the error of the first row that failed.
void rethrow_bench_error();

/// Work to measure. Steps are queued and then waited for together, so that the cost of a wait is shared.
struct Work {
  std::function<void()> step;
  std::function<void()> wait{};         ///< empty: a step is done when it returns
  std::function<double()> device_ns{};  ///< device time of the last wait; negative if unknown
  int in_line = 1;
};

/// Steps on a backend, with its wait and, if it has one, the device's clock. The step ends by writing `last`.
Work work_on(Backend& backend, const Buffer& last, std::function<void()> step);

/// Device time of the submission last waited for; empty if there is no such clock.
std::function<double()> device_clock(Backend& backend);

/// Measures the work; one step does this number of units.
void time_work(benchmark::State& state, const Work& work, double units, std::string_view unit);

/// Makes an object shared by several rows when the first of them runs. `make` returns a std::shared_ptr.
template <class Make>
auto shared_by_rows(Make make) {
  using Pointer = decltype(make());
  return [make = std::move(make), made = std::make_shared<Pointer>()]() -> typename Pointer::element_type& {
    if (!*made) *made = make();
    return **made;
  };
}

/// A log to map, with its settings.
struct BenchLog {
  std::string file;
  ReadOptions read;
  MapperConfig mapper;
  MapperOptions options;
  bool loops = true;    ///< `live`: false: each scan is matched with one map of all scans
  double speed = 50.0;  ///< `live`: pace relative to the stamps; 0: as fast as possible
};

/// Copies, and on a CPU random loads from tables that fit into the first cache, the second, or neither.
void add_limits(const BenchTarget& target);
/// The kernels on the benchmark cases of the shared list.
void add_kernels(const BenchTarget& target);
/// A scan from its points to its pose, and its merge into the map.
void add_scans(const BenchTarget& target);
/// The beams of a nodding laser's sweep on their way to cloud points.
void add_sweeps(const BenchTarget& target);
/// Times of each scan of a log as it arrives.
void add_live(const BenchTarget& cpu, const BenchLog& log);
/// Device work of mapping a log with the matcher `exhaustive`: kernels, barriers, copies, waits.
void add_work(const BenchTarget& device, const BenchLog& log);

}  // namespace gdtslam
