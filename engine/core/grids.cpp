#include "gdtslam/core/grids.hpp"

#include <algorithm>

namespace gdtslam {

CellStates::CellStates(std::span<const CellState> states) : CellStates(states.size()) {
  for (std::size_t cell = 0; cell < states.size(); ++cell) set(cell, states[cell]);
}

void CellStates::read(std::size_t first, std::span<CellState> states) const {
  for (std::size_t i = 0; i < states.size();) {
    const std::size_t in_block = (first + i) % kBlock;
    const std::size_t count = std::min(kBlock - in_block, states.size() - i);
    const auto out = states.subspan(i, count);
    if (const std::uint32_t block = blocks_[(first + i) / kBlock]; block == 0) {
      std::fill(out.begin(), out.end(), CellState::kUnknown);
    } else {
      for (std::size_t k = 0; k < count; ++k) out[k] = state_in(pool_[block - 1], in_block + k);
    }
    i += count;
  }
}

std::vector<CellState> CellStates::all() const {
  std::vector<CellState> states(size_);
  read(0, states);
  return states;
}

DistanceFieldRows rows_of(const DistanceFieldView& field) {
  return {field.geometry, field.cap, [field](std::int32_t y, std::span<std::uint16_t> row) {
            const auto cells = field.cells.subspan(static_cast<std::size_t>(y) * field.stride, row.size());
            std::copy(cells.begin(), cells.end(), row.begin());
          }};
}

}  // namespace gdtslam
