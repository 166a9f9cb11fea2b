// A job that uses every verb: seeds up, a pass of a distance transform and its field, fills, downloads of both kinds.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

inline constexpr std::uint32_t kJobWidth = 96;
inline constexpr std::uint32_t kJobHeight = 70;
inline constexpr std::uint32_t kJobRadius = 20;

/// The field of one pattern of seeds, merged into what `global` holds; everything recorded, nothing started.
inline void record_job(Backend& backend, const Buffer& global, std::uint64_t random_seed) {
  const std::uint32_t stride = grid_stride(kJobWidth);
  const std::size_t cells = std::size_t{stride} * kJobHeight;
  const auto seeds = make_seeds(SeedPattern::kSparse, kJobWidth, kJobHeight, stride, random_seed);
  const auto table = distance_table(kJobRadius);
  const Buffer seed_buffer = backend.allocate(cells);
  const Buffer nearest = backend.allocate(cells * 4);
  const Buffer squares = backend.allocate(cells * 2);
  const Buffer field = backend.allocate(cells * 2);
  const Buffer table_buffer = backend.allocate(table.size() * 2);
  backend.upload(seed_buffer, std::as_bytes(std::span(seeds)));
  backend.upload(table_buffer, std::as_bytes(std::span(table)));
  const Extent all{kJobWidth, kJobHeight, 1};
  run<JumpFloodInit>(backend, {kJobWidth, kJobHeight, stride}, all, seed_buffer, nearest);
  run<JumpFloodDistance>(backend, {kJobWidth, kJobHeight, stride, kJobRadius}, all, nearest, squares);
  run<DistanceField>(backend,
                     {.width = kJobWidth,
                      .height = kJobHeight,
                      .stride = stride,
                      .table_size = static_cast<std::uint32_t>(table.size())},
                     all, squares, table_buffer, field);
  run<GdtMerge>(backend,
                {.scan_width = kJobWidth,
                 .scan_height = kJobHeight,
                 .scan_stride = stride,
                 .global_stride = stride,
                 .threshold = 256,
                 .lift = 200,
                 .cap = field_cap(kJobRadius)},
                all, global, field);
}

inline Buffer new_map(Backend& backend) {
  Buffer global = backend.allocate(std::size_t{grid_stride(kJobWidth)} * kJobHeight * 2);
  const std::uint32_t cap = field_cap(kJobRadius);
  backend.fill(global, cap << 16U | cap);
  return global;
}

/// The cells of the map after `rounds` merges, without the padding.
inline std::vector<std::byte> run_job(Backend& backend, int rounds) {
  const Buffer global = new_map(backend);
  for (int round = 0; round < rounds; ++round) {
    record_job(backend, global, static_cast<std::uint64_t>(round) + 1);
    if (round % 2 == 0) {
      backend.flush();
    }
  }
  std::vector<std::byte> all(global.bytes());
  const PendingDownload download = backend.start_download(global, all.size(), 0);
  backend.flush();
  backend.finish_download(download, all);
  std::vector<std::byte> cells;
  const std::size_t row_bytes = std::size_t{grid_stride(kJobWidth)} * 2;
  for (std::uint32_t y = 0; y < kJobHeight; ++y) {
    const auto row = all.begin() + static_cast<std::ptrdiff_t>(y * row_bytes);
    cells.insert(cells.end(), row, row + std::ptrdiff_t{kJobWidth} * 2);
  }
  return cells;
}

}  // namespace gdtslam::test
