// Rows of `gdtslam-lab bench`, registered with google-benchmark, which chooses the iterations, repeats, filters and
// writes JSON. A row is named DEVICE/GROUP/NAME/VARIANT; google-benchmark adds the clock and the like behind that.
// Times are of one step; the counter `device_s` has the time of the device's own clock. tools/scripts/benchmarks.py
// computes ratios to limits from the JSON.
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

/// Registers a row. An error that it throws is shown in its place, and kept for rethrow_bench_error(); after an
/// interrupt the rows that are left are skipped.
benchmark::internal::Benchmark* add_row(const BenchTarget& target, std::string_view group, std::string_view name,
                                        std::string_view variant, std::function<void(benchmark::State&)> measure);

/// Rethrows the error of the first row that failed.
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
std::function<double()> device_clock(Backend& backend);

/// Times the work, whose step does so many units of it.
void time_work(benchmark::State& state, const Work& work, double units, std::string_view unit);

/// Makes an object that several rows share, when the first of them is measured. `make` returns a std::shared_ptr.
template <class Make>
auto shared_by_rows(Make make) {
  using Pointer = decltype(make());
  return [make = std::move(make), made = std::make_shared<Pointer>()]() -> typename Pointer::element_type& {
    if (!*made) *made = make();
    return **made;
  };
}

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
/// Times of each scan of a log as it comes.
void add_live(const BenchTarget& cpu, const BenchLog& log);
/// Work that mapping a log by the matcher `exhaustive` asks of a device: kernels, barriers, copies, waits.
void add_work(const BenchTarget& device, const BenchLog& log);

}  // namespace gdtslam
