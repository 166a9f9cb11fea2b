// Scans that wait in memory and in a file: each comes back with all that it had.
#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <vector>

#include "engine/runs/mapping/laser_shelf.hpp"

namespace gdtslam {
namespace {

LaserScan numbered_scan(std::size_t number) {
  const auto x = static_cast<double>(number);
  LaserScan scan{.stamp_s = x + 0.1,
                 .first_bearing_rad = x + 0.2,
                 .bearing_step_rad = x + 0.3,
                 .max_range_m = x + 0.4,
                 .first_beam_after_s = x + 0.5,
                 .beam_period_s = -x - 0.6,
                 .speed = {},
                 .ranges_m = std::vector<float>(number % 7, static_cast<float>(x) + 0.7F),
                 .T_base_laser = {x + 0.8, x + 0.9, x + 1.1}};
  if (number % 3 == 0) scan.speed.emplace(x + 1.2, x + 1.3, x + 1.4);
  if (!scan.ranges_m.empty()) scan.ranges_m.back() = std::numeric_limits<float>::infinity();
  return scan;
}

void expect_same(const LaserScan& a, const LaserScan& b) {
  EXPECT_EQ(a.stamp_s, b.stamp_s);
  EXPECT_EQ(a.first_bearing_rad, b.first_bearing_rad);
  EXPECT_EQ(a.bearing_step_rad, b.bearing_step_rad);
  EXPECT_EQ(a.max_range_m, b.max_range_m);
  EXPECT_EQ(a.first_beam_after_s, b.first_beam_after_s);
  EXPECT_EQ(a.beam_period_s, b.beam_period_s);
  ASSERT_EQ(a.speed.has_value(), b.speed.has_value());
  if (a.speed) {
    EXPECT_EQ(*a.speed, *b.speed);
  }
  EXPECT_EQ(a.ranges_m, b.ranges_m);
  EXPECT_TRUE(a.T_base_laser == b.T_base_laser);
}

TEST(LaserShelf, GivesBackWhatWasPut) {
  for (const std::size_t memory_bytes : {std::size_t{0}, std::size_t{4000}, ByteShelf::kMemoryBytes}) {
    LaserShelf shelf(testing::TempDir(), memory_bytes);
    for (std::size_t i = 0; i < 200; ++i) shelf.put(numbered_scan(i));
    EXPECT_EQ(shelf.bytes().size(), 200U);
    EXPECT_EQ(shelf.bytes().bytes_in_file() > 0, memory_bytes < ByteShelf::kMemoryBytes);
    LaserShelf::Reader reader(shelf);
    for (std::size_t i = 0; i < 200; ++i) expect_same(reader.next(), numbered_scan(i));
  }
}

TEST(LaserShelf, AReaderGoesOnWithWhatIsPutAfterIt) {
  for (const std::size_t memory_bytes : {std::size_t{0}, std::size_t{4000}, ByteShelf::kMemoryBytes}) {
    LaserShelf shelf(testing::TempDir(), memory_bytes);
    LaserShelf::Reader reader(shelf);
    for (std::size_t i = 0; i < 200; ++i) {
      shelf.put(numbered_scan(2 * i));
      shelf.put(numbered_scan(2 * i + 1));
      expect_same(reader.next(), numbered_scan(i));
    }
    for (std::size_t i = 200; i < 400; ++i) expect_same(reader.next(), numbered_scan(i));
  }
}

}  // namespace
}  // namespace gdtslam
