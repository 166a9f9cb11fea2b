// The occupancy map, its marks and its counters against plain ones: a beam that steps from cell to cell, sets of cells
// and one number a cell.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/mapping/map/scan_marks.hpp"
#include "engine/mapping/map/tile_counts.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {
namespace {

using Place = std::pair<std::int64_t, std::int64_t>;

// The next border along an axis: how far it is, in 1/512 cell.
std::int64_t to_border(std::int64_t at, bool forward) {
  const std::int64_t into = ((at % 512) + 512) % 512;
  return forward ? 512 - into : into;
}

// From cell to cell over the border that comes first, that in y where both come at once.
std::vector<Place> cells_crossed(const SubCell& start, const SubCell& end) {
  const std::int64_t run_x = std::abs(end.x - start.x);
  const std::int64_t run_y = std::abs(end.y - start.y);
  std::int64_t border_x = to_border(start.x, end.x > start.x);
  std::int64_t border_y = to_border(start.y, end.y > start.y);
  Place cell{start.cell().x, start.cell().y};
  const Place last{end.cell().x, end.cell().y};
  std::vector<Place> cells{cell};
  while (cell != last) {
    if (border_x * run_y < border_y * run_x) {
      cell.first += end.x > start.x ? 1 : -1;
      border_x += 512;
    } else {
      cell.second += end.y > start.y ? 1 : -1;
      border_y += 512;
    }
    cells.push_back(cell);
  }
  return cells;
}

void add_bits(const ScanMarks::Tile& tile, const TileBits& bits, bool turned, std::set<Place>& cells) {
  for (std::int64_t line = 0; line < 64; ++line) {
    for (std::int64_t bit = 0; bit < 64; ++bit) {
      if ((bits[static_cast<std::size_t>(line)] >> bit & 1U) == 0) continue;
      cells.emplace(tile.place.x * 64 + (turned ? line : bit), tile.place.y * 64 + (turned ? bit : line));
    }
  }
}

CellBox box_around(const SubCell& a, const SubCell& b) {
  const CellIndex p = a.cell();
  const CellIndex q = b.cell();
  return {{std::min(p.x, q.x), std::min(p.y, q.y)}, {std::max(p.x, q.x) + 1, std::max(p.y, q.y) + 1}};
}

void expect_same_cells(ScanMarks& marks, const SubCell& start, const SubCell& end) {
  marks.clear(box_around(start, end));
  marks.add_ray(start, end);
  std::set<Place> marked;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    add_bits(marks[k], marks[k].rows, false, marked);
    add_bits(marks[k], marks[k].columns, true, marked);
  }
  const std::vector<Place> crossed = cells_crossed(start, end);
  ASSERT_EQ(marked, std::set<Place>(crossed.begin(), crossed.end()))
      << start.x << ", " << start.y << " to " << end.x << ", " << end.y;
}

SubCell sub_cell(std::int64_t x, std::int64_t y) { return {2 * x + 1, 2 * y + 1}; }

TEST(ScanMarks, RaysOfAllLengthsCrossTheCellsThatStepsDo) {
  Random random(3);
  ScanMarks marks;
  for (const double reach : {3.0, 300.0, 20000.0, 200000.0}) {
    for (int round = 0; round < 500; ++round) {
      const auto coordinate = [&] { return static_cast<std::int64_t>(std::floor(random.uniform(-reach, reach))); };
      const SubCell start = sub_cell(coordinate(), coordinate());
      expect_same_cells(marks, start, sub_cell(coordinate(), coordinate()));
    }
  }
}

// From corner to corner of the cells, along the axes and beside them.
TEST(ScanMarks, RaysThroughCornersTakeTheUpperOrLowerCellFirst) {
  ScanMarks marks;
  for (const std::int64_t run : {1, 255, 256, 257, 512, 25600, 65536}) {
    for (const auto& [x, y] : {Place{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {1, 0}, {0, -1}, {2, 1}, {-1, 2}, {3, -1}}) {
      for (const std::int64_t at : {0, 100, 127, 128, 255}) {
        expect_same_cells(marks, sub_cell(at, at), sub_cell(at + x * run, at + y * run));
        expect_same_cells(marks, sub_cell(at, 255 - at), sub_cell(at + x * run, 255 - at + y * run));
      }
    }
  }
}

TEST(ScanMarks, FarFromTheAnchorIsAsNear) {
  ScanMarks marks;
  const std::int64_t far = (std::int64_t{1} << 38) - 70000;
  expect_same_cells(marks, sub_cell(-far, far), sub_cell(-far + 60001, far - 20011));
  expect_same_cells(marks, sub_cell(far, -far), sub_cell(far - 777, -far - 60000));
}

TEST(ScanMarks, TransposeMovesEachBitToItsPlace) {
  Random random(9);
  TileBits bits;
  for (std::uint64_t& row : bits) row = random.bits();
  TileBits turned = bits;
  transpose(turned);
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t x = 0; x < 64; ++x) ASSERT_EQ(bits[y] >> x & 1U, turned[x] >> y & 1U) << x << ", " << y;
  }
}

/// One number a counter; both are halved when one is full.
struct PlainCount {
  std::uint32_t ends = 0;
  std::uint32_t passes = 0;
  void add(bool is_end) {
    (is_end ? ends : passes) += 1;
    if (std::max(ends, passes) < 65535) return;
    ends /= 2;
    passes /= 2;
  }
};

// The columns of a row differ in how often they are seen, and in how often that is an end: 0 to 7 of 8 times.
TEST(TileCounts, AreThoseOfPlainNumbersAndAreHalvedWhenFull) {
  Random random(17);
  std::array<PlainCount, 64> plain{};
  TileCounts counts;
  constexpr std::size_t kRow = 13;
  for (int scan = 1; scan <= 300000; ++scan) {
    const std::uint64_t some = random.bits() | random.bits();
    const std::uint64_t seen = scan % 5 == 0 ? some : some | 0xffffffffU;
    const std::uint64_t draws[3] = {random.bits(), random.bits(), random.bits()};
    TileBits ends{};
    TileBits passes{};
    for (unsigned column = 0; column < 64; ++column) {
      if ((seen >> column & 1U) == 0) continue;
      const std::uint64_t draw =
          (draws[0] >> column & 1U) + 2 * (draws[1] >> column & 1U) + 4 * (draws[2] >> column & 1U);
      const bool is_end = draw < column % 8;
      (is_end ? ends : passes)[kRow] |= std::uint64_t{1} << column;
      plain[column].add(is_end);
    }
    counts.add(ends, passes);
    const bool is_looked_at = scan < 50 || scan % 997 == 0;
    for (unsigned column = 0; is_looked_at && column < 64; ++column) {
      ASSERT_EQ(counts.at(kRow, column).ends, plain[column].ends) << scan << ", " << column;
      ASSERT_EQ(counts.at(kRow, column).passes, plain[column].passes) << scan << ", " << column;
      ASSERT_EQ((counts.ended(kRow) >> column & 1U) != 0, plain[column].ends > 0);
      ASSERT_EQ((counts.passed(kRow) >> column & 1U) != 0, plain[column].passes > 0);
    }
  }
}

/// The whole rule, with a number a cell.
class PlainOccupancy {
 public:
  explicit PlainOccupancy(const OccupancyConfig& config) : config_(config) {}
  void add(const LaserScan& scan, const Pose2& pose, double resolution_m, double limit_m) {
    std::set<Place> ends;
    std::set<Place> passed;
    for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
      const bool is_return = static_cast<double>(scan.ranges_m[k]) < limit_m;
      const double length_m = is_return ? static_cast<double>(scan.ranges_m[k]) : config_.no_return_free_m;
      const auto beam = sin_cos(scan.first_bearing_rad + static_cast<double>(k) * scan.bearing_step_rad);
      const auto heading = sin_cos(pose.theta_rad);
      const double x_m = beam.cos * length_m;
      const double y_m = beam.sin * length_m;
      const auto steps = [resolution_m](double m) {
        return static_cast<std::int64_t>(std::floor(m / resolution_m * 256.0));
      };
      const SubCell start = sub_cell(steps(pose.x_m), steps(pose.y_m));
      const SubCell end = sub_cell(steps(pose.x_m + heading.cos * x_m - heading.sin * y_m),
                                   steps(pose.y_m + heading.sin * x_m + heading.cos * y_m));
      const std::vector<Place> cells = cells_crossed(start, end);
      passed.insert(cells.begin(), cells.end());
      if (is_return) ends.insert(cells.back());
    }
    for (const Place& cell : passed) counts_[cell].add(ends.count(cell) > 0);
  }
  [[nodiscard]] std::map<Place, CellState> known() const {
    std::map<Place, CellState> states;
    for (const auto& [cell, count] : counts_) {
      const double share = count.ends / static_cast<double>(count.ends + count.passes);
      if (static_cast<std::int32_t>(count.ends) >= config_.min_ends && share >= config_.occupied_share) {
        states[cell] = CellState::kOccupied;
      } else if (count.passes > 0) {
        states[cell] = CellState::kFree;
      }
    }
    return states;
  }

 private:
  OccupancyConfig config_;
  std::map<Place, PlainCount> counts_;
};

// Scans from many places, with walls that agree now and then, and beams that come back from nowhere.
TEST(Occupancy, ManyScansGiveTheMapOfThePlainRule) {
  const OccupancyConfig config{.occupied_share = 0.4, .min_ends = 2, .no_return_free_m = 3.0};
  OccupancyBuilder builder(config, {.resolution_m = 0.05, .min_range_m = 0.01, .max_range_m = 40.0});
  PlainOccupancy plain(config);
  Random random(29);
  for (int k = 0; k < 400; ++k) {
    LaserScan scan{.stamp_s = 0.0,
                   .first_bearing_rad = -1.5,
                   .bearing_step_rad = 0.1,
                   .max_range_m = 0.0,
                   .ranges_m = {},
                   .T_base_laser = {}};
    for (int beam = 0; beam < 30; ++beam) {
      scan.ranges_m.push_back(random.uniform(0.0, 1.0) < 0.1 ? 50.0F : static_cast<float>(random.uniform(0.1, 12.0)));
    }
    const Pose2 pose{0.5 * std::floor(random.uniform(-10.0, 10.0)), 0.5 * std::floor(random.uniform(-3.0, 3.0)),
                     random.uniform(-3.0, 3.0)};
    for (int again = 0; again < 1 + k % 3; ++again) {
      builder.add(scan, pose);
      plain.add(scan, pose, 0.05, 40.0);
    }
  }
  const OccupancyMap map = builder.build();
  const std::map<Place, CellState> known = plain.known();
  std::int64_t left = 1 << 20;
  std::int64_t low = 1 << 20;
  std::size_t walls = 0;
  for (const auto& [cell, state] : known) {
    left = std::min(left, cell.first);
    low = std::min(low, cell.second);
    walls += state == CellState::kOccupied ? 1 : 0;
  }
  EXPECT_GT(walls, 1000U);
  EXPECT_EQ(map.geometry.origin_x_m, static_cast<double>(left) * 0.05);
  EXPECT_EQ(map.geometry.origin_y_m, static_cast<double>(low) * 0.05);
  std::size_t seen = 0;
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      const auto found = known.find({left + x, low + y});
      const CellState expected = found == known.end() ? CellState::kUnknown : found->second;
      ASSERT_EQ(map.at({x, y}), expected) << x << ", " << y;
      seen += expected == CellState::kUnknown ? 0 : 1;
    }
  }
  EXPECT_EQ(seen, known.size());
}

}  // namespace
}  // namespace gdtslam
