#include "field_store.hpp"

#include <algorithm>
#include <cassert>

#include "field_rows.hpp"
#include "field_strips.hpp"

namespace gdtslam {

void FieldStore::read_row(CellIndex first, std::span<std::uint16_t> cells) const {
  assert(!memory_.empty());
  const CellOffset d = first - stored_.min;
  auto x = static_cast<std::size_t>(d.dx);
  for (std::size_t i = 0; i < cells.size();) {
    const std::size_t count = std::min(kStripWidth - x % kStripWidth, cells.size() - i);
    const auto piece = memory_.subspan(layout_.place(x, static_cast<std::size_t>(d.dy)), count);
    std::transform(piece.begin(), piece.end(), cells.begin() + static_cast<std::ptrdiff_t>(i),
                   [blank = layout_.blank](std::uint16_t cell) { return static_cast<std::uint16_t>(cell ^ blank); });
    i += count;
    x += count;
  }
}

std::unique_ptr<FieldStore> make_field_store(Backend& backend, std::uint16_t cap, std::uint64_t max_cells) {
  if (backend.device().kind == "cpu") return std::make_unique<FieldStrips>(backend, cap);
  return std::make_unique<FieldRows>(backend, cap, max_cells);
}

}  // namespace gdtslam
