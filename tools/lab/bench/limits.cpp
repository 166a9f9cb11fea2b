// What this machine does at most, measured in the same run as the kernels: a plain copy, and independent loads from
// random places of a table, one by one and by the gather instructions of the backend's instruction set. Tables of three
// sizes: within the first cache of a core, within the second, and in memory. One thread.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/core/random.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace gdtslam {
namespace {

struct TableSize {
  std::size_t bytes;
  std::string_view name;
  bool is_table;  // else it is only copied, as kernels of about that size are compared with it
};
// The first table fits beside its indices into 32 KiB, the last into no cache of today.
constexpr std::array<TableSize, 6> kTableSizes{{{std::size_t{1} << 14U, "16 KiB", true},
                                                {std::size_t{1} << 18U, "256 KiB", true},
                                                {std::size_t{1} << 20U, "1 MiB", false},
                                                {std::size_t{1} << 22U, "4 MiB", false},
                                                {std::size_t{1} << 24U, "16 MiB", false},
                                                {std::size_t{1} << 27U, "128 MiB", true}}};
// Enough places that those of the large table are in no cache either.
constexpr std::size_t kFewestPlaces = std::size_t{1} << 11U;
constexpr std::size_t kMostPlaces = std::size_t{1} << 21U;

using Words = std::vector<std::uint32_t>;
using LoadFunction = std::uint32_t (*)(std::span<const std::uint32_t> table, std::span<const std::uint32_t> places);

/// The loads do not wait for each other: four sums.
std::uint32_t single_loads(std::span<const std::uint32_t> table, std::span<const std::uint32_t> places) {
  std::array<std::uint32_t, 4> sums{};
  for (std::size_t i = 0; i < places.size(); i += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += table[places[i + k]];
  }
  return sums[0] + sums[1] + sums[2] + sums[3];
}

#ifdef __x86_64__
[[gnu::target("avx2")]] std::uint32_t gathers_avx2(std::span<const std::uint32_t> table,
                                                   std::span<const std::uint32_t> places) {
  const auto* const from = reinterpret_cast<const int*>(table.data());
  __m256i sum_a = _mm256_setzero_si256();
  __m256i sum_b = sum_a;
  const __m256i all = _mm256_set1_epi32(-1);
  const __m256i zero = _mm256_setzero_si256();
  for (std::size_t i = 0; i < places.size(); i += 16) {
    const auto* const at = reinterpret_cast<const __m256i*>(places.data() + i);
    sum_a = _mm256_add_epi32(sum_a, _mm256_mask_i32gather_epi32(zero, from, _mm256_loadu_si256(at), all, 4));
    sum_b = _mm256_add_epi32(sum_b, _mm256_mask_i32gather_epi32(zero, from, _mm256_loadu_si256(at + 1), all, 4));
  }
  std::array<std::uint32_t, 8> sums{};
  const __m256i both = _mm256_add_epi32(sum_a, sum_b);
  std::memcpy(sums.data(), &both, sizeof(sums));
  return std::accumulate(sums.begin(), sums.end(), 0U);
}

[[gnu::target("avx512f")]] std::uint32_t gathers_avx512(std::span<const std::uint32_t> table,
                                                        std::span<const std::uint32_t> places) {
  constexpr __mmask16 kAll = 0xFFFF;
  const __m512i zero = _mm512_setzero_si512();
  __m512i sum_a = zero;
  __m512i sum_b = zero;
  for (std::size_t i = 0; i < places.size(); i += 32) {
    const std::uint32_t* const at = places.data() + i;
    sum_a = _mm512_add_epi32(sum_a, _mm512_mask_i32gather_epi32(zero, kAll, _mm512_loadu_si512(at), table.data(), 4));
    sum_b =
        _mm512_add_epi32(sum_b, _mm512_mask_i32gather_epi32(zero, kAll, _mm512_loadu_si512(at + 16), table.data(), 4));
  }
  std::array<std::uint32_t, 16> sums{};
  const __m512i both = _mm512_add_epi32(sum_a, sum_b);
  std::memcpy(sums.data(), &both, sizeof(sums));
  return std::accumulate(sums.begin(), sums.end(), 0U);
}
#endif

/// Null where the instruction set has no gather.
LoadFunction gathers_of(Isa isa) {
#ifdef __x86_64__
  if (isa == Isa::kAvx512) return gathers_avx512;
  if (isa == Isa::kAvx2) return gathers_avx2;
#endif
  return nullptr;
}

void measure_loads(benchmark::State& state, const TableSize& size, LoadFunction load) {
  const Words table(size.bytes / sizeof(std::uint32_t), 1);
  Words places(std::clamp(table.size() / 2, kFewestPlaces, kMostPlaces));
  Random random(1);
  for (std::uint32_t& place : places) place = static_cast<std::uint32_t>(random.below(table.size()));
  const auto step = [&] { benchmark::DoNotOptimize(load(table, places)); };
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
  for (const auto& [name, load] :
       {std::pair{"load", LoadFunction{single_loads}}, std::pair{"gather", gathers_of(target.backend.host_isa())}}) {
    for (const TableSize& size : kTableSizes) {
      if (!size.is_table || load == nullptr) continue;
      add_row(target, "limit", name, std::string(size.name) + " table",
              [size, load = load](benchmark::State& state) { measure_loads(state, size, load); });
    }
  }
}

}  // namespace gdtslam
