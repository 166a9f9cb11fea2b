#include "growth.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr std::int32_t kSmallest = 64;       // cells of a whole margin
constexpr std::int64_t kWholeMargin = 4096;  // number of parts of a margin

// `needed`, which holds `stored`, with some parts of a margin at each side that moved.
CellBox with_margin(const CellBox& stored, const CellBox& needed, std::int64_t parts) {
  const auto margin = [parts](std::int32_t extent) {
    return static_cast<std::int32_t>(std::max(kSmallest, extent / 4) * parts / kWholeMargin);
  };
  const std::int32_t margin_x = margin(needed.width());
  const std::int32_t margin_y = margin(needed.height());
  CellBox grown = needed;
  if (stored.empty() || needed.min.x < stored.min.x) grown.min.x -= margin_x;
  if (stored.empty() || needed.min.y < stored.min.y) grown.min.y -= margin_y;
  if (stored.empty() || needed.end.x > stored.end.x) grown.end.x += margin_x;
  if (stored.empty() || needed.end.y > stored.end.y) grown.end.y += margin_y;
  return grown;
}

// Adds the largest margin that fits; `needed` itself fits.
CellBox with_largest_margin(const CellBox& stored, const CellBox& needed,
                            const std::function<bool(const CellBox&)>& fits) {
  if (const CellBox whole = with_margin(stored, needed, kWholeMargin); fits(whole)) return whole;
  std::int64_t fitting = 0;
  for (std::int64_t too_many = kWholeMargin; too_many - fitting > 1;) {
    const std::int64_t parts = (fitting + too_many) / 2;
    (fits(with_margin(stored, needed, parts)) ? fitting : too_many) = parts;
  }
  return with_margin(stored, needed, fitting);
}

}  // namespace

CellBox bounding_box(const CellBox& a, const CellBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.end.x, b.end.x), std::max(a.end.y, b.end.y)}};
}

CellBox common_part(const CellBox& a, const CellBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)},
          {std::min(a.end.x, b.end.x), std::min(a.end.y, b.end.y)}};
}

std::string size_text(const CellBox& box) {
  return std::to_string(box.width()) + " x " + std::to_string(box.height()) + " cells";
}

std::optional<GridBoxes> grown_to_hold(const GridBoxes& now, const CellBox& box,
                                       const std::function<bool(const CellBox&)>& fits) {
  const CellBox content = bounding_box(now.content, box);
  const CellBox needed = bounding_box(now.stored, box);
  if (needed == now.stored) return GridBoxes{content, needed};
  if (fits(needed)) return GridBoxes{content, with_largest_margin(now.stored, needed, fits)};
  // Margins on all sides, so that growing to alternate sides does not copy the grid every time.
  if (fits(content)) return GridBoxes{content, with_largest_margin({}, content, fits)};
  return std::nullopt;
}

}  // namespace gdtslam
