// One row merged by the kernel on the CPU, with an instruction set. Cells in 1/256 cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

/// The scan's cells merged into the global ones, as one row.
inline std::vector<std::uint16_t> merged(Isa isa, GdtMerge::Params params, std::vector<std::uint16_t> global,
                                         const std::vector<std::uint16_t>& scan) {
  params.scan_width = static_cast<std::uint32_t>(scan.size());
  params.scan_height = 1;
  params.scan_stride = params.global_stride = (params.scan_width + 3) / 4 * 4;
  const auto backend = make_cpu_backend({.threads = 1, .isa = isa});
  const Buffer map = backend->allocate(2 * global.size());
  const Buffer seen = backend->allocate(2 * scan.size());
  backend->upload(map, std::as_bytes(std::span(global)));
  backend->upload(seen, std::as_bytes(std::span(scan)));
  run<GdtMerge>(*backend, params, {params.scan_width, 1, 1}, map, seen);
  backend->download(map, std::as_writable_bytes(std::span(global)));
  return global;
}

}  // namespace gdtslam::test
