// Merges a keyframe into the map in one step, paper equations (1) and (9) to (11). The distance field of its obstacles
// is the minimum of one disc of values around each of them, because the table of distances is monotone; only the tiles
// reached by a disc are touched. The bits are those of an exact transform, DistanceField and GdtMerge on the window.
//
// Per cell of a tile: D = the least stamp_disc() value over the tile's obstacles within the radius, the cap if there is
// none; then the rule of gdt_merge.hpp. Obstacles may repeat; their order has no effect.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// Side of a tile in cells.
inline constexpr std::uint32_t kStampTile = 64;
/// Obstacles are listed in groups of this size; the last one of a tile is repeated to fill its group.
inline constexpr std::uint32_t kStampGroup = 4;
/// Cells of cap on either side of a disc's row, so that pieces of a tile's row can be read at any shift.
inline constexpr std::uint32_t kDiscMargin = 32;

/// A tile of the field and its obstacles: four words of the list.
struct StampTile {
  std::uint32_t base = 0;   ///< index of its lower left cell in the field, a multiple of 4
  std::uint32_t size = 0;   ///< height * 65536 + width of what may be written, 1 to kStampTile each
  std::uint32_t first = 0;  ///< word of its obstacles in the list, a multiple of kStampGroup
  std::uint32_t count = 0;  ///< number of obstacles, at least 1
};

/// Cells from row to row of a disc.
constexpr std::uint32_t disc_stride(std::uint32_t radius) { return (2 * radius + 1 + 2 * kDiscMargin + 3) / 4 * 4; }

/// Field values around an obstacle: row |dy| = 0 .. R, column dx + R + kDiscMargin; round(256*sqrt(dx*dx+dy*dy)), the
/// cap beyond R.
std::vector<std::uint16_t> stamp_disc(std::uint32_t radius);

/// Bindings: field (u16, read and write), list (u32, read), disc (u16, read). The list has the tiles, no two of which
/// share a cell, and after them their obstacles, (y + R) * 65536 + x + R from the tile's lower left cell: 0 is the
/// farthest left or below that counts. If the field has strips, the tiles begin at columns that are multiples of 64,
/// and the first cell of a row also goes to the 65th of the strip before, if there is one. Extent: x = tiles.
struct GdtStamp {
  struct Params {
    std::uint32_t tile_count = 0;
    std::uint32_t words = 0;           ///< words of the list
    std::uint32_t most_obstacles = 0;  ///< most obstacles of a tile
    std::uint32_t stride = 0;          ///< cells from row to row within a tile
    std::uint32_t radius = 0;          ///< R, 1 to 255 cells
    std::uint32_t threshold = 0;       ///< 1/256 cell
    std::uint32_t lift = 0;            ///< kappa * threshold, 1/256 cell; at most threshold
    std::uint32_t cap = 0;
    MergeRule rule = MergeRule::kWorking;
    std::uint32_t strip = kStripWidth;  ///< FieldLayout
    std::uint32_t blank = 0;
  };
  static constexpr std::array kBindings{Access::kReadWrite, Access::kRead, Access::kRead};
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam
