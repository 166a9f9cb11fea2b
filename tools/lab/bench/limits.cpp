// Limits of this machine, measured in the same run as the kernels: a plain copy, and independent loads from random
// places of a table. Tables of three sizes: within the first cache of a core, within the second, and in memory. One
// thread.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/random.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

struct TableSize {
  std::size_t bytes;
  std::string_view name;
  bool is_table;  // else only copied, as a limit for kernels of this size
};
// The first table and its indices fit into 32 KiB, the last one into no cache of today.
constexpr std::array<TableSize, 6> kTableSizes{{{std::size_t{1} << 14U, "16 KiB", true},
                                                {std::size_t{1} << 18U, "256 KiB", true},
                                                {std::size_t{1} << 20U, "1 MiB", false},
                                                {std::size_t{1} << 22U, "4 MiB", false},
                                                {std::size_t{1} << 24U, "16 MiB", false},
                                                {std::size_t{1} << 27U, "128 MiB", true}}};
// Enough positions that those of the large table are in no cache either.
constexpr std::size_t kFewestPlaces = std::size_t{1} << 11U;
constexpr std::size_t kMostPlaces = std::size_t{1} << 21U;

/// Sums in four accumulators, so that the loads do not wait for each other.
std::uint32_t single_loads(std::span<const std::uint32_t> table, std::span<const std::uint32_t> places) {
  std::array<std::uint32_t, 4> sums{};
  for (std::size_t i = 0; i < places.size(); i += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += table[places[i + k]];
  }
  return sums[0] + sums[1] + sums[2] + sums[3];
}

void measure_loads(benchmark::State& state, const TableSize& size) {
  const std::vector<std::uint32_t> table(size.bytes / sizeof(std::uint32_t), 1);
  std::vector<std::uint32_t> places(std::clamp(table.size() / 2, kFewestPlaces, kMostPlaces));
  Random random(1);
  for (std::uint32_t& place : places) place = static_cast<std::uint32_t>(random.below(table.size()));
  const auto step = [&] { benchmark::DoNotOptimize(single_loads(table, places)); };
  time_work(state, {.step = step}, static_cast<double>(places.size()), "load");
}

void measure_copy(benchmark::State& state, Backend& backend, std::size_t bytes) {
  const double traffic = 2.0 * static_cast<double>(bytes);
  if (auto* const device = dynamic_cast<VulkanBackend*>(&backend)) {
    const Buffer from = device->allocate(bytes);
    const Buffer to = device->allocate(bytes);
    return time_work(state, work_on(*device, to, [&] { device->copy(from, to); }), traffic, "byte");
  }
  const std::vector<std::byte> from(bytes, std::byte{1});
  std::vector<std::byte> to(bytes);
  const auto step = [&] {
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::ClobberMemory();
  };
  time_work(state, {.step = step}, traffic, "byte");
}

}  // namespace

void add_limits(const BenchTarget& target) {
  for (const TableSize& size : kTableSizes) {
    add_row(target, "limit", "copy", size.name,
            [size, &backend = target.backend](benchmark::State& state) { measure_copy(state, backend, size.bytes); });
  }
  if (!target.is_cpu()) return;
  for (const TableSize& size : kTableSizes) {
    if (!size.is_table) continue;
    add_row(target, "limit", "load", std::string(size.name) + " table",
            [size](benchmark::State& state) { measure_loads(state, size); });
  }
}

}  // namespace gdtslam
