#include <gtest/gtest.h>

#include "engine/compute/kernels/distance_field/distance_field.hpp"

namespace gdtslam::test {
namespace {

// t = round(256 sqrt(d)) exactly when (2t - 1)^2 <= 4 * 65536 * d < (2t + 1)^2; halves cannot occur but at d = 0.
TEST(DistanceTable, RoundsToNearestForEveryRadius) {
  for (std::uint32_t radius = 0; radius <= 255; ++radius) {
    const std::vector<std::uint16_t> table = distance_table(radius);
    ASSERT_EQ(table.size(), radius * radius + 1U);
    ASSERT_EQ(table.front(), 0);
    ASSERT_EQ(table.back(), field_cap(radius));
  }
  const std::vector<std::uint16_t> table = distance_table(255);
  for (std::uint64_t sq = 1; sq < table.size(); ++sq) {
    const std::uint64_t twice = 2 * std::uint64_t{table[sq]};
    ASSERT_LE((twice - 1) * (twice - 1), 4 * 65536 * sq) << sq;
    ASSERT_GT((twice + 1) * (twice + 1), 4 * 65536 * sq) << sq;
  }
}

TEST(DistanceTable, KnownValues) {
  const std::vector<std::uint16_t> table = distance_table(5);
  EXPECT_EQ(table[1], 256);
  EXPECT_EQ(table[2], 362);  // 256 * 1.41421 = 362.04
  EXPECT_EQ(table[3], 443);  // 443.405
  EXPECT_EQ(table[5], 572);  // 572.433
  EXPECT_EQ(table[25], 1280);
}

}  // namespace
}  // namespace gdtslam::test
