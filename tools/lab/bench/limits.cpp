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
#include <string_view>
#include <vector>

#include "gdtslam/core/random.hpp"
#include "rows.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace gdtslam {
namespace {

struct TableSize {
  std::size_t bytes;
  std::string_view copy;
  std::string_view table;
};
// The first fits beside its indices into 32 KiB, the last into no cache of today.
constexpr std::array<TableSize, 3> kTableSizes{{{std::size_t{1} << 14U, "16 KiB", "16 KiB table"},
                                                {std::size_t{1} << 18U, "256 KiB", "256 KiB table"},
                                                {std::size_t{1} << 27U, "128 MiB", "128 MiB table"}}};
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

BenchRow load_row(std::string_view name, const TableSize& size, LoadFunction load, const TimingOptions& options) {
  const Words table(size.bytes / sizeof(std::uint32_t), 1);
  Words places(std::clamp(table.size() / 2, kFewestPlaces, kMostPlaces));
  Random random(1);
  for (std::uint32_t& place : places) place = static_cast<std::uint32_t>(random.below(table.size()));
  const auto step = [&] {
    const std::uint32_t sum = load(table, places);
    asm volatile("" : : "r"(sum) : "memory");  // the loads are for their own sake
  };
  return measured_row("limit", name, size.table, "load", static_cast<double>(places.size()), {.step = step}, options);
}

}  // namespace

std::vector<BenchRow> bench_limits(Backend& backend, const TimingOptions& options) {
  std::vector<BenchRow> rows;
  rows.reserve(3 * kTableSizes.size());
  for (const TableSize& size : kTableSizes) rows.push_back(copy_row(size.copy, size.bytes, options));
  for (const TableSize& size : kTableSizes) rows.push_back(load_row("load", size, single_loads, options));
  if (const LoadFunction gather = gathers_of(backend.host_isa())) {
    for (const TableSize& size : kTableSizes) rows.push_back(load_row("gather", size, gather, options));
  }
  return rows;
}

void compare_with_limits(std::span<BenchRow> rows, std::span<const BenchRow> limits) {
  double most = 0.0;
  for (const BenchRow& limit : limits) {
    if (limit.unit == "load") most = std::max(most, limit.work / limit.timing.cpu_s);
  }
  for (BenchRow& row : rows) {
    if (row.unit == "look-up" && most > 0.0) row.load_ratio = row.work / row.timing.cpu_s / most;
  }
}

}  // namespace gdtslam
