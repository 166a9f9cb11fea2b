// States in two bits a cell against a plain vector of them.
#include <vector>

#include <gtest/gtest.h>

#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

TEST(CellStates, HoldWhatAVectorHolds) {
  Random random(11);
  for (const std::size_t size : {0U, 1U, 31U, 33U, 511U, 512U, 513U, 4000U}) {
    std::vector<CellState> expected(size, CellState::kUnknown);
    CellStates states(size);
    ASSERT_EQ(states.size(), size);
    EXPECT_EQ(states.all(), expected);
    for (std::size_t k = 0; k < 3 * size; ++k) {
      const std::size_t cell = random.below(size);
      expected[cell] = static_cast<CellState>(random.below(3));
      states.set(cell, expected[cell]);
    }
    EXPECT_EQ(states.all(), expected);
    EXPECT_EQ(states, CellStates(expected));
    for (std::size_t cell = 0; cell < size; ++cell) ASSERT_EQ(states[cell], expected[cell]) << cell;
    for (int k = 0; k < 20 && size > 0; ++k) {
      const std::size_t first = random.below(size);
      std::vector<CellState> part(random.below(size - first) + 1, CellState::kOccupied);
      states.read(first, part);
      const auto from = expected.begin() + static_cast<std::ptrdiff_t>(first);
      EXPECT_EQ(part, std::vector<CellState>(from, from + static_cast<std::ptrdiff_t>(part.size())));
    }
  }
}

// A block of unknown cells is the same whether it was ever written to or not.
TEST(CellStates, AreEqualByWhatTheyHold) {
  CellStates written(600);
  written.set(550, CellState::kFree);
  EXPECT_FALSE(written == CellStates(600));
  written.set(550, CellState::kUnknown);
  EXPECT_TRUE(written == CellStates(600));
  EXPECT_FALSE(written == CellStates(601));
}

}  // namespace
}  // namespace gdtslam
