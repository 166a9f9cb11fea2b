// The sums of the minorants of a field under points that lie where every number is exact: each term by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kWordsWide = 40;
constexpr std::uint32_t kWordsHigh = 30;
constexpr std::int32_t kAnchorColumn = 12;
constexpr std::int32_t kAnchorRow = 9;

std::uint32_t word_of(std::int32_t constant, std::int32_t slope_x, std::int32_t slope_y) {
  return (static_cast<std::uint32_t>(constant) & 0xFFFFU) | (static_cast<std::uint32_t>(slope_x) & 0xFFU) << 16U |
         (static_cast<std::uint32_t>(slope_y) & 0xFFU) << 24U;
}

std::int32_t constant_at(std::int32_t column, std::int32_t row) { return 7 * column - 11 * row; }
std::int32_t slope_x_at(std::int32_t column, std::int32_t row) { return column - 2 * row; }
std::int32_t slope_y_at(std::int32_t column, std::int32_t row) { return row - column; }

std::vector<std::uint32_t> field_of_words() {
  std::vector<std::uint32_t> words;
  for (std::int32_t row = 0; row < static_cast<std::int32_t>(kWordsHigh); ++row) {
    for (std::int32_t column = 0; column < static_cast<std::int32_t>(kWordsWide); ++column) {
      words.push_back(word_of(constant_at(column, row), slope_x_at(column, row), slope_y_at(column, row)));
    }
  }
  return words;
}

PoseMinorantWide::Params params_for(std::size_t points, std::uint32_t unit, float slack) {
  return {.width = kWordsWide,
          .height = kWordsHigh,
          .anchor_x = kAnchorColumn,
          .anchor_y = kAnchorRow,
          .point_count = static_cast<std::uint32_t>(points),
          .constant_unit = unit,
          .half_angle = 0.0F,
          .slack = slack};
}

/// Points a quarter of a cell right of and an eighth below the centres of cells, so that with a box at 0 no sum rounds.
std::vector<BoundPoint> points_beside_centres(std::size_t count) {
  std::vector<BoundPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    points.push_back({static_cast<float>(k % 20) - 8.0F + 0.75F, static_cast<float>(k % 13) - 5.0F + 0.375F, 0});
  }
  return points;
}

/// By the definition of pose_bounds.hpp, each term rounded down, less two units for each point.
PoseMinorant::Value by_hand(const std::vector<BoundPoint>& points, std::int32_t unit, double slack) {
  PoseMinorant::Value sum;
  for (const BoundPoint& point : points) {
    const auto column = static_cast<std::int32_t>(std::floor(point.x)) + kAnchorColumn;
    const auto row = static_cast<std::int32_t>(std::floor(point.y)) + kAnchorRow;
    const double slope_x = 3.0 * slope_x_at(column, row);
    const double slope_y = 3.0 * slope_y_at(column, row);
    const double rise = 0.25 * slope_x - 0.125 * slope_y - slack * (std::fabs(slope_x) + std::fabs(slope_y));
    sum.constant += unit * constant_at(column, row) + static_cast<std::int32_t>(std::floor(rise)) - 2;
    sum.slope_x += static_cast<std::int32_t>(slope_x);
    sum.slope_y += static_cast<std::int32_t>(slope_y);
    const double turn = (slope_y * static_cast<double>(point.x) - slope_x * static_cast<double>(point.y)) / 16.0;
    sum.slope_theta += static_cast<std::int32_t>(std::floor(turn));
  }
  return sum;
}

TEST(PoseMinorantWide, SumsAreThoseOfTheWordsUnderThePoints) {
  const std::vector<std::uint32_t> words = field_of_words();
  const PoseCandidate boxes[] = {{}, {}};
  for (const Isa isa : available_isas()) {
    for (const std::size_t count : {1U, 15U, 16U, 17U, 256U, 257U, 600U}) {  // of vectors, and of blocks
      for (const std::uint32_t unit : {1U, 3U}) {
        for (const double slack : {0.0, 0.0625}) {
          const std::vector<BoundPoint> points = points_beside_centres(count);
          const PoseMinorantWide::Params params = params_for(count, unit, static_cast<float>(slack));
          PoseMinorant::Value values[2];
          pose_minorant_wide_host(isa, params, words.data(), points.data(), boxes, 2, values);
          const PoseMinorant::Value expected = by_hand(points, static_cast<std::int32_t>(unit), slack);
          for (const PoseMinorant::Value& value : values) {
            EXPECT_EQ(value.constant, expected.constant) << count << ' ' << unit << ' ' << slack;
            EXPECT_EQ(value.slope_x, expected.slope_x) << count;
            EXPECT_EQ(value.slope_y, expected.slope_y) << count;
            EXPECT_EQ(value.slope_theta, expected.slope_theta) << count;
          }
        }
      }
    }
  }
}

TEST(PoseMinorantWide, APointReadsTheFieldThatItNames) {
  std::vector<std::uint32_t> words = field_of_words();
  const std::vector<std::uint32_t> other(words.size(), word_of(1000, 0, 0));
  words.insert(words.end(), other.begin(), other.end());
  std::vector<BoundPoint> points = points_beside_centres(2);
  points[1].field = static_cast<std::uint32_t>(other.size());
  const PoseCandidate box;
  PoseMinorant::Value value;
  pose_minorant_wide_host(Isa::kBaseline, params_for(2, 1, 0.0F), words.data(), points.data(), &box, 1, &value);
  const PoseMinorant::Value first = by_hand({points[0]}, 1, 0.0);
  EXPECT_EQ(value.constant, first.constant + 1000 - 2);
  EXPECT_EQ(value.slope_theta, first.slope_theta);
}

TEST(PoseMinorantWide, BeyondTheEdgeLiesTheEdge) {
  const std::vector<std::uint32_t> words = field_of_words();
  const std::vector<BoundPoint> points{{100.5F, 0.5F, 0}, {-100.5F, 0.5F, 0}, {0.5F, 100.5F, 0}, {0.5F, -100.5F, 0}};
  const std::int32_t edges[][2] = {
      {kWordsWide - 1, kAnchorRow}, {0, kAnchorRow}, {kAnchorColumn, kWordsHigh - 1}, {kAnchorColumn, 0}};
  const PoseCandidate box;
  for (std::size_t k = 0; k < points.size(); ++k) {
    PoseMinorant::Value value;
    pose_minorant_wide_host(Isa::kBaseline, params_for(1, 1, 0.0F), words.data(), &points[k], &box, 1, &value);
    EXPECT_EQ(value.constant, constant_at(edges[k][0], edges[k][1]) - 2) << k;
  }
}

}  // namespace
}  // namespace gdtslam::test
