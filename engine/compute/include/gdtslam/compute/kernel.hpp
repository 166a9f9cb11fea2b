// A kernel is data plus implementations: its name, its bindings, the size of its parameters, one CPU function per
// instruction set and, when built with Vulkan, its SPIR-V. The name is also the stem of its shaders; kernels that
// belong together share a header and a CPU file (docs/adding-a-kernel.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gdtslam {

/// A point of the scan, in cells, in the frame of the candidates' poses.
struct PointCells {
  float x = 0.0F;
  float y = 0.0F;
};

/// How the cost reads the field between cell centres, and whether it sums distances or their squares (pose_cost).
enum class Interpolation : std::uint32_t { kBilinear = 0, kNearest = 1 };
enum class CostForm : std::uint32_t { kDistance = 0, kSquared = 1 };

/// Paper equations (9) to (11) in the working form or as printed (gdt_merge).
enum class MergeRule : std::uint32_t { kWorking = 0, kLiteral = 1 };

/// Paper equation (14) in the working form or as printed (sweep_points).
enum class SweepForm : std::uint32_t { kWorking = 0, kLiteral = 1 };

/// Computation of a field's squared distances: exact (GdtStamp), or by jump flooding, which has occasional errors.
enum class DistanceTransform : std::uint8_t { kExact, kJumpFlood };

// Layout of the cells of a distance field, for the kernels that look up a map or merge into it. Cell (x, y) is at (x /
// 64) * strip + x % 64 + y * stride. With strips 64 cells apart the layout is plain rows, one behind the other.
// Otherwise the field lies in strips of 64 columns, all rows of a strip before the next strip. The row of a strip has a
// 65th cell, which repeats the first cell of the next strip, so that the four neighbours of a look-up lie in one strip.
// The cells around a scan then take few pages of memory, and memory that is allocated at the first touch is used only
// for known parts. A cell holds its value XOR `blank`. If `blank` is the cap, memory that begins as zeros is an unknown
// map.

/// Columns of a strip; a distance of as many cells from strip to strip means rows.
inline constexpr std::uint32_t kStripWidth = 64;
/// Cells from row to row of a strip: the 65th, and a multiple of 4.
inline constexpr std::uint32_t kStripStride = 68;

/// Distances in cells.
struct FieldLayout {
  std::uint32_t stride = 0;           ///< from row to row, a multiple of 4
  std::uint32_t strip = kStripWidth;  ///< from strip to strip, a multiple of 4
  std::uint32_t blank = 0;            ///< value that turns unknown cells into 0 by XOR, or 0

  [[nodiscard]] constexpr bool has_strips() const { return strip != kStripWidth; }
  [[nodiscard]] constexpr std::size_t place(std::size_t x, std::size_t y) const {
    return x / kStripWidth * strip + x % kStripWidth + y * stride;
  }
  friend bool operator==(const FieldLayout&, const FieldLayout&) = default;
};

/// How a kernel uses a binding; barriers between dispatches follow from it.
enum class Access : std::uint8_t { kRead, kWrite, kReadWrite };

/// Number of invocations of a dispatch.
struct Extent {
  std::uint32_t x = 1;
  std::uint32_t y = 1;
  std::uint32_t z = 1;
  friend bool operator==(const Extent&, const Extent&) = default;
};

/// Instruction sets that the CPU kernels are compiled for, from the weakest to the strongest.
enum class Isa : std::uint8_t { kBaseline, kAvx2, kAvx512 };
inline constexpr std::size_t kIsaCount = 3;
std::string_view to_string(Isa isa);

/// Arguments of a CPU function: the buffers in the order of the bindings, the parameters, and its slice of the
/// outermost non-trivial dimension of the extent (y when y > 1, else x). Slices never write the same byte.
struct CpuLaunch {
  std::span<const std::span<std::byte>> buffers;
  std::span<const std::byte> params;
  Extent threads;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};
using CpuFunction = void (*)(const CpuLaunch&);

/// A dispatch before it runs, as input of its checks: sizes only, so that one check serves every backend.
struct LaunchShape {
  std::span<const std::size_t> buffer_bytes;
  std::span<const std::byte> params;
  Extent threads;
};
/// Throws Error if parameters, extent and buffer sizes do not fit each other.
using CheckFunction = void (*)(const LaunchShape&);
/// Elementary steps of a dispatch (cells or look-ups): determines whether threads are woken, and scales benchmarks.
using WorkFunction = std::uint64_t (*)(const LaunchShape&);

/// One row of the registry.
struct KernelInfo {
  std::string_view name;
  std::span<const Access> bindings;
  std::size_t params_bytes = 0;              ///< push constants, at most 128, a multiple of 4
  std::array<CpuFunction, kIsaCount> cpu{};  ///< null if the build has no such instruction set
  CheckFunction check = nullptr;
  WorkFunction work = nullptr;
  std::string_view work_unit;  ///< name of a step: "cell", "look-up", "value", "beam"
  std::string_view source;     ///< citation key and equation
};

/// Largest block of parameters: the size of push constants that every Vulkan device accepts.
inline constexpr std::size_t kMaxParamsBytes = 128;
/// Throws Error unless the dispatch names a buffer per binding and its sizes pass the kernel's own check.
void check_launch(const KernelInfo& kernel, const LaunchShape& shape);

/// Every kernel of the project, in a fixed order.
std::span<const KernelInfo* const> kernel_registry();
/// The kernel of that name, or nullptr.
const KernelInfo* find_kernel(std::string_view name);

}  // namespace gdtslam
