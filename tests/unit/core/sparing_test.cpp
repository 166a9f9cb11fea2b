// Vectors that grow for hours: what they hold, and how much more room they have.
#include "engine/core/memory/sparing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace gdtslam {
namespace {

TEST(Sparing, HasRoomForAnEighthMoreAtMost) {
  std::vector<std::size_t> values;
  std::size_t moves = 0;
  for (std::size_t i = 0; i < 100'000; ++i) {
    const std::size_t* const before = values.data();
    push_sparingly(values, i);
    moves += values.data() != before ? 1U : 0U;
    ASSERT_LE(values.capacity(), values.size() + std::max<std::size_t>(16, values.size() / 8));
  }
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], i);
  EXPECT_LE(moves, 80U);  // 8 until 128, then log(100,000 / 128) / log(9 / 8) = 57
}

}  // namespace
}  // namespace gdtslam
