#include "field_store.hpp"

#include <algorithm>
#include <cassert>

#include "field_rows.hpp"
#include "field_strips.hpp"
#include "growth.hpp"

namespace gdtslam {

void FieldStore::read_row(CellIndex first, std::span<std::uint16_t> all, std::uint16_t cap) const {
  std::fill(all.begin(), all.end(), cap);
  const CellBox row{first, first + CellOffset{static_cast<std::int32_t>(all.size()), 1}};
  const CellBox part = common_part(row, stored_);
  if (part.empty()) return;
  assert(!memory_.empty());
  const auto cells =
      all.subspan(static_cast<std::size_t>(part.min.x - first.x), static_cast<std::size_t>(part.width()));
  const CellOffset d = part.min - stored_.min;
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

std::string limit_of_option(std::uint64_t max_cells) {
  return ", more than map.max_megacells allows (" + std::to_string(max_cells >> 20U) +
         " x 2^20); check the log with 'gdtslam doctor' or raise the limit";
}

std::unique_ptr<FieldStore> make_field_store(Backend& backend, std::uint16_t cap, std::uint64_t max_cells) {
  if (backend.device().kind == "cpu") return std::make_unique<FieldStrips>(backend, cap);
  return std::make_unique<FieldRows>(backend, cap, max_cells);
}

}  // namespace gdtslam
