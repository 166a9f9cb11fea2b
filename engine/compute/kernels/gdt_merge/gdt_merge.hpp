// Merge of a scan's distance field D into the global distance transform G, paper equations (9) to (11) in the form of
// docs/paper.md. All in 1/256 cell, integers. Working rule, in this order, d = G - D:
//   D = cap: unchanged; G = cap: G := D; |d| <= threshold: G := (G + D) >> 1; d < 0: unchanged; d > 0: G := D + lift.
// A value above the cap counts as the cap in the first two lines. Literal rule: the same first three lines, then d > 0:
// unchanged; d < 0: G := min(D + lift, cap). Before a merge the global field may have to grow, which FieldGrow does.
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// Bindings: global field (u16, read and write), scan field (u16, read). The scan field's cell (0, 0) lies at cell
/// (offset_x, offset_y) of the global one, and the whole scan field must lie inside. If the global field has strips,
/// the first cell of a row in a strip is also written to the 65th of the strip before, if there is one. Extent: x =
/// scan width, y = scan rows.
struct GdtMerge {
  struct Params {
    std::uint32_t scan_width = 0;
    std::uint32_t scan_height = 0;
    std::uint32_t scan_stride = 0;
    std::uint32_t global_stride = 0;
    std::uint32_t offset_x = 0;
    std::uint32_t offset_y = 0;
    std::uint32_t threshold = 0;  ///< 1/256 cell
    std::uint32_t lift = 0;       ///< kappa * threshold, 1/256 cell; at most threshold
    std::uint32_t cap = 0;
    MergeRule rule = MergeRule::kWorking;
    std::uint32_t global_strip = kStripWidth;  ///< FieldLayout of the global field
    std::uint32_t blank = 0;
  };
  static constexpr std::array kBindings{Access::kReadWrite, Access::kRead};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// Copies a field into a larger one, so that the map grows without leaving the device: new(x, y) = old(x - offset_x, y
/// - offset_y) inside the old field, else `cap`. The old field may be empty (0 x 0) and must lie inside the new one.
/// Padding of the new rows is undefined. Bindings: old field (u16, read), new field (u16, write). Extent: x = new
/// width, y = new rows.
struct FieldGrow {
  struct Params {
    std::uint32_t old_width = 0;
    std::uint32_t old_height = 0;
    std::uint32_t old_stride = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t offset_x = 0;
    std::uint32_t offset_y = 0;
    std::uint32_t cap = 0;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

}  // namespace gdtslam
