#include "growth.hpp"

#include <algorithm>

namespace gdtslam {

CellBox hull_of(const CellBox& a, const CellBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.end.x, b.end.x), std::max(a.end.y, b.end.y)}};
}

CellBox with_margin(const CellBox& stored, const CellBox& needed) {
  constexpr std::int32_t kSmallest = 64;  // cells
  const std::int32_t margin_x = std::max(kSmallest, needed.width() / 4);
  const std::int32_t margin_y = std::max(kSmallest, needed.height() / 4);
  CellBox grown = needed;
  if (stored.empty() || needed.min.x < stored.min.x) grown.min.x -= margin_x;
  if (stored.empty() || needed.min.y < stored.min.y) grown.min.y -= margin_y;
  if (stored.empty() || needed.end.x > stored.end.x) grown.end.x += margin_x;
  if (stored.empty() || needed.end.y > stored.end.y) grown.end.y += margin_y;
  return grown;
}

}  // namespace gdtslam
