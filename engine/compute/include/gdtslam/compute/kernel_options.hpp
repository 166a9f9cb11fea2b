// Choices of the kernels that the configuration of a matcher, a merge or a cloud passes on; the kernels say what each
// does. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>

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

/// How the squared distances of a field are found: exactly (GdtStamp), or by jump flooding, which errs now and then.
enum class DistanceTransform : std::uint8_t { kExact, kJumpFlood };

// Layout of the cells of a distance field, for the kernels that look up a map or merge into it. Cell (x, y) is at
// (x / 64) * strip + x % 64 + y * stride. With strips 64 cells apart the layout is plain rows, one behind the other.
// Else the field lies in strips of 64 columns, all rows of a strip before the next strip, and a strip's row has a 65th
// cell, which repeats the first cell of the next strip, so that the four neighbours of a look-up lie in one strip: few
// pages of memory hold what a scan sees, and memory that a system gives when it is touched is taken only for known
// parts. A cell holds its value XOR `blank`; with the cap for that, memory that begins as zeros is an unknown map.

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

}  // namespace gdtslam
